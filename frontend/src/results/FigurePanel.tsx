import { Anchor, Group, Text } from "@mantine/core";
import { IconTableDown } from "@tabler/icons-react";
import type { ReactNode } from "react";
import type { FigureEntry } from "../client";
import { Panel } from "../platform/Panel";
import { Prose } from "../platform/Prose";

type FigurePanelProps = {
  entry: Pick<FigureEntry, "title" | "how" | "is_available" | "reason">;
  actions: ReactNode;
  children: ReactNode;
};

/** What stands around a figure: its title, how it is computed, what there is to take away; or why it is not there. */
export function FigurePanel({ entry, actions, children }: FigurePanelProps) {
  return (
    <Panel title={entry.title} about={<Prose text={entry.how} />} actions={actions}>
      {entry.is_available ? (
        children
      ) : (
        <Text fz="sm" c="dimmed">
          {entry.reason}
        </Text>
      )}
    </Panel>
  );
}

/** The numbers of a figure to take away. */
export function TableLink({ title, href, fileName }: { title: string; href: string; fileName: string }) {
  return (
    <Anchor fz="sm" href={href} aria-label={`Table: ${title}`} download={fileName}>
      <Group gap={4} wrap="nowrap">
        <IconTableDown size={16} aria-hidden />
        Table
      </Group>
    </Anchor>
  );
}
