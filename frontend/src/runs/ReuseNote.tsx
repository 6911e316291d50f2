import { List, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { Run } from "../client";
import { Panel } from "../platform/Panel";
import { reuseQuery } from "./queries";
import { reuseLines } from "./reuse";

/** What a run took over from the one before, and why the rest was done anew; nothing for the first run. */
export function ReuseNote({ run }: { run: Run }) {
  const { data } = useQuery({ ...reuseQuery(run), enabled: run.number > 1 });
  if (!data || data.compared_with === null) return null;
  return (
    <Panel title="Taken over from earlier runs">
      <List size="sm" spacing={4}>
        {reuseLines(data).map(({ stage, text }) => (
          <List.Item key={stage}>
            <Text span fz="sm" fw={500}>
              {stage}:
            </Text>{" "}
            {text}
          </List.Item>
        ))}
      </List>
    </Panel>
  );
}
