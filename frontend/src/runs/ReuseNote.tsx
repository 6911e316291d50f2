import { Anchor, Collapse, Group, List, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import type { Run } from "../client";
import { reuseQuery } from "./queries";
import { reuseLines, reuseSummary } from "./reuse";

/** What a run took over from the one before, in a line; why the rest was done anew for who asks. */
export function ReuseNote({ run }: { run: Run }) {
  const [isOpen, { toggle }] = useDisclosure();
  const { data } = useQuery({ ...reuseQuery(run), enabled: run.number > 1 });
  if (!data || data.compared_with === null) return null;
  return (
    <div>
      <Group gap="xs">
        <Text fz="sm" c="dimmed">
          {reuseSummary(data)}
        </Text>
        <Anchor component="button" type="button" fz="sm" aria-expanded={isOpen} onClick={toggle}>
          {isOpen ? "Less" : "Why"}
        </Anchor>
      </Group>
      <Collapse expanded={isOpen}>
        <List size="sm" spacing={4} mt={4}>
          {reuseLines(data).map(({ stage, text }) => (
            <List.Item key={stage}>
              <Text span fz="sm" fw={500}>
                {stage}:
              </Text>{" "}
              {text}
            </List.Item>
          ))}
        </List>
      </Collapse>
    </div>
  );
}
