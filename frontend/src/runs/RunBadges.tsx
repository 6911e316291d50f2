import { Badge, Group, Text } from "@mantine/core";
import { colourOfRun } from "./colour";
import { type RunState, STATE_COLOURS } from "./states";

/** A state as a word on its colour. */
export function StateBadge({ state }: { state: RunState | string }) {
  return (
    <Badge variant="light" color={STATE_COLOURS[state] ?? "gray"} radius="sm" tt="none" className="state">
      {state}
    </Badge>
  );
}

/** The run's own colour and its number. */
export function RunName({ number, size = "sm" }: { number: number; size?: string }) {
  return (
    <Group gap={8} wrap="nowrap" component="span" display="inline-flex">
      <span
        aria-hidden
        style={{ width: 10, height: 10, borderRadius: "50%", background: colourOfRun(number), flex: "none" }}
      />
      <Text
        span
        fz={size}
        fw={size === "inherit" ? "inherit" : 500}
        inherit={size === "inherit"}
        style={{ whiteSpace: "nowrap" }}
      >
        Run {number}
      </Text>
    </Group>
  );
}
