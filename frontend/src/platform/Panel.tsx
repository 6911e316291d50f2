import { Group, Paper, Stack, Text, Title } from "@mantine/core";
import { type ReactNode, useId } from "react";

type PanelProps = { title: string; about?: ReactNode; actions?: ReactNode; children: ReactNode };

/** A titled region of a page. */
export function Panel({ title, about, actions, children }: PanelProps) {
  const id = useId();
  return (
    <Paper
      component="section"
      aria-labelledby={id}
      withBorder
      p="md"
      style={{ borderColor: "var(--dropflow-line)" }}
    >
      <Stack gap="sm">
        <Group justify="space-between" align="baseline" gap="xs">
          <div>
            <Title order={2} id={id}>
              {title}
            </Title>
            {about && (
              <Text c="dimmed" fz="sm">
                {about}
              </Text>
            )}
          </div>
          {actions}
        </Group>
        {children}
      </Stack>
    </Paper>
  );
}
