import { Breadcrumbs, Group, Stack, Title } from "@mantine/core";
import { useDocumentTitle } from "@mantine/hooks";
import type { ReactNode } from "react";

type PageProps = {
  title: string;
  /** What stands in the title's place on the page, where it is more than text. */
  heading?: ReactNode;
  /** Links to the pages above this one. */
  above?: ReactNode[];
  beside?: ReactNode;
  actions?: ReactNode;
  children: ReactNode;
};

/** One page: the way back, its title, what can be done with it as a whole, its content. */
export function Page({ title, heading, above = [], beside, actions, children }: PageProps) {
  useDocumentTitle(`${title} · Dropflow`);
  return (
    <Stack gap="lg">
      <Stack gap={6}>
        {above.length > 0 && (
          <Breadcrumbs component="nav" aria-label="Way back" fz="sm">
            {above}
          </Breadcrumbs>
        )}
        <Group justify="space-between" align="center" gap="sm">
          <Group gap="sm" align="center" style={{ minWidth: 0 }}>
            <Title order={1} style={{ overflowWrap: "anywhere" }}>
              {heading ?? title}
            </Title>
            {beside}
          </Group>
          <Group gap="xs">{actions}</Group>
        </Group>
      </Stack>
      {children}
    </Stack>
  );
}
