import { Paper, SimpleGrid, Text } from "@mantine/core";
import type { Run } from "../client";
import { keyNumbers } from "./summary";

/** The few numbers that people look for first. */
export function KeyNumbers({ run }: { run: Run }) {
  const numbers = keyNumbers(run.summary);
  if (numbers.length === 0) return null;
  return (
    <SimpleGrid cols={{ base: 2, sm: 3, lg: numbers.length }} spacing="sm" component="dl" m={0}>
      {numbers.map(({ name, value, unit, about }) => (
        <Paper key={name} withBorder px="md" py="sm" style={{ borderColor: "var(--dropflow-line)" }}>
          <Text component="dt" fz="xs" c="dimmed">
            {name}
          </Text>
          <Text component="dd" m={0} fz="xl" fw={600} className="numbers" lh={1.3}>
            {value}
            {unit && (
              <Text span fz="sm" fw={400} c="dimmed">
                {" "}
                {unit}
              </Text>
            )}
          </Text>
          {about && (
            <Text fz="xs" c="dimmed" component="dd" m={0}>
              {about}
            </Text>
          )}
        </Paper>
      ))}
    </SimpleGrid>
  );
}
