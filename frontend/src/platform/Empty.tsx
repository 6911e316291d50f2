import { Stack, Text, Title } from "@mantine/core";
import type { ReactNode } from "react";

type EmptyProps = { title: string; children?: ReactNode; action?: ReactNode };

/** Nothing here yet, and what to do about it. */
export function Empty({ title, children, action }: EmptyProps) {
  return (
    <Stack align="center" gap="xs" py="xl" ta="center" maw={520} mx="auto">
      <Title order={2}>{title}</Title>
      {children && (
        <Text c="dimmed" component="div">
          {children}
        </Text>
      )}
      {action}
    </Stack>
  );
}
