import { ActionIcon, Button, Group, Paper, Stack, Title } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import type { Run, Trajectory } from "../client";
import { type Fact, Facts } from "../platform/Facts";
import { formatCount, formatNumber, plural } from "../platform/format";
import { QueryView } from "../platform/QueryView";
import { trajectoryQuery } from "./queries";
import { Trace } from "./Trace";

type DropletPanelProps = {
  run: Run;
  trajectoryId: number;
  frame: number;
  onFrame: (frame: number) => void;
  onClose: () => void;
};

/** One droplet over time: size, speed and what it is made of, and how sure it is. */
export function DropletPanel({ run, trajectoryId, frame, onFrame, onClose }: DropletPanelProps) {
  const query = useQuery(trajectoryQuery(run, trajectoryId));
  return (
    <Paper withBorder p="sm" component="section" aria-label={`Droplet ${trajectoryId}`}>
      <Stack gap="xs">
        <Group justify="space-between" wrap="nowrap">
          <Title order={3}>Droplet {formatCount(trajectoryId)}</Title>
          <ActionIcon variant="subtle" color="gray" aria-label="Close" onClick={onClose}>
            <IconX size={16} aria-hidden />
          </ActionIcon>
        </Group>
        <QueryView query={query}>
          {(droplet) => <Story droplet={droplet} frame={frame} onFrame={onFrame} />}
        </QueryView>
      </Stack>
    </Paper>
  );
}

const RISE = "#0b84c4";
const SINK = "#c2571a";
const SIDE = "#12906c";

function Story({
  droplet,
  frame,
  onFrame,
}: {
  droplet: Trajectory;
  frame: number;
  onFrame: (frame: number) => void;
}) {
  const [first, last] = [droplet.frame[0] ?? 0, droplet.frame.at(-1) ?? 0];
  const here = droplet.frame.indexOf(frame);
  const { upward, across } = motionOf(droplet);
  const flow = upward.map((speed, index) => minus(speed, droplet.sedimentation_um_s[index] ?? null));
  const at = here >= 0 ? droplet.time_s[here] : undefined;
  const plot = { x: droplet.time_s, at, onPick: (index: number) => onFrame(droplet.frame[index] ?? frame) };
  return (
    <Stack gap="xs">
      <Facts label="This droplet here" facts={factsOf(droplet, here)} />
      <Trace
        title="Radius"
        unit="µm"
        series={[{ name: "radius", colour: RISE, values: droplet.r_um }]}
        {...plot}
      />
      <Trace
        title="Upward velocity"
        unit="µm/s"
        series={[
          { name: "all", colour: RISE, values: upward },
          { name: "sedimentation", colour: SINK, values: droplet.sedimentation_um_s },
          { name: "flow", colour: SIDE, values: flow, isDashed: true },
        ]}
        {...plot}
      />
      <Trace
        title="Velocity across"
        unit="µm/s"
        series={[{ name: "across", colour: SIDE, values: across }]}
        {...plot}
      />
      <Trace
        title="Match"
        height={90}
        series={[{ name: "match", colour: RISE, values: droplet.match }]}
        {...plot}
      />
      <Group gap="xs" grow>
        <Button size="xs" variant="default" onClick={() => onFrame(first)} disabled={frame === first}>
          First frame, {formatCount(first)}
        </Button>
        <Button size="xs" variant="default" onClick={() => onFrame(last)} disabled={frame === last}>
          Last frame, {formatCount(last)}
        </Button>
      </Group>
    </Stack>
  );
}

/** Velocity against gravity, and to the right of that direction. */
function motionOf({ u_um_s, v_um_s, up }: Trajectory) {
  const along = (x: number, y: number) =>
    u_um_s.map((u, index) => {
      const v = v_um_s[index];
      return u === null || v == null ? null : u * x + v * y;
    });
  return { upward: along(up[0], up[1]), across: along(-up[1], up[0]) };
}

function minus(left: number | null, right: number | null): number | null {
  return left === null || right === null ? null : left - right;
}

function factsOf(droplet: Trajectory, here: number): Fact[] {
  const n_predicted = droplet.is_detected.filter((isDetected) => !isDetected).length;
  const life: Fact = [
    "Followed for",
    `${plural(droplet.frame.length, "frame")}${n_predicted > 0 ? `, ${formatCount(n_predicted)} by prediction` : ""}`,
  ];
  if (here < 0) return [life, ["In this frame", "not there"]];
  const std = droplet.r_std_um[here];
  const radius = `${formatNumber(droplet.r_um[here])}${std == null ? "" : ` ± ${formatNumber(std, 2)}`} µm`;
  const [probability, match] = [droplet.probability[here], droplet.match[here]];
  return [
    life,
    ["Radius", radius],
    ["Match", formatNumber(match)],
    ...(probability == null ? [] : [["Probability", formatNumber(probability)] as Fact]),
    ["In this frame", droplet.is_detected[here] ? "detected" : "found by prediction"],
  ];
}
