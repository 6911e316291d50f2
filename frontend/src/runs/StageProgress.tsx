import { Group, Progress, Stack, Text } from "@mantine/core";
import type { Stage } from "../client";
import { formatCount, formatDuration, formatNumber } from "../platform/format";
import { StateBadge } from "./RunBadges";
import { STAGE_TITLES, STATE_COLOURS } from "./states";

/** Every stage of a run: done of total, speed, time left. */
export function Stages({ stages }: { stages: Stage[] }) {
  return (
    <Stack gap="sm">
      {stages.map((stage) => (
        <StageRow key={stage.name} stage={stage} />
      ))}
    </Stack>
  );
}

function StageRow({ stage }: { stage: Stage }) {
  const title = STAGE_TITLES[stage.name] ?? stage.name;
  const percent = percentOf(stage);
  return (
    <div>
      <Group justify="space-between" gap="xs" mb={4}>
        <Group gap="xs">
          <Text fz="sm" fw={500}>
            {title}
          </Text>
          <StateBadge state={stage.state} />
        </Group>
        <Text fz="sm" c="dimmed" className="numbers">
          {detailsOf(stage)}
        </Text>
      </Group>
      <Progress.Root size="sm">
        <Progress.Section
          value={percent}
          color={STATE_COLOURS[stage.state]}
          aria-label={`${title}: ${Math.floor(percent)} % done`}
        />
      </Progress.Root>
    </div>
  );
}

export function percentOf({ state, done_frames, total_frames }: Stage): number {
  if (state === "completed") return 100;
  return total_frames > 0 ? Math.min(100, (100 * done_frames) / total_frames) : 0;
}

/** `about 2 min 11 s left, ± 12 s`: two standard deviations, which the truth rarely leaves; nothing below a second. */
function timeLeft(left_s: number, std_s: number | null): string {
  const left = `about ${formatDuration(Math.ceil(left_s))} left`;
  const off_s = Math.round(2 * (std_s ?? 0));
  return off_s >= 1 ? `${left}, ± ${formatDuration(off_s)}` : left;
}

/** `120 of 400 frames (40 from an earlier run), 2.1 frames/s, about 2 min left, ± 9 s` */
export function detailsOf(stage: Stage): string {
  const parts = [`${formatCount(stage.done_frames)} of ${formatCount(stage.total_frames)} frames`];
  if (stage.reused_frames > 0) parts[0] += ` (${formatCount(stage.reused_frames)} from an earlier run)`;
  if (stage.state === "running") {
    if (stage.frames_per_s) parts.push(`${formatNumber(stage.frames_per_s, 2)} frames/s`);
    if (stage.seconds_left != null) parts.push(timeLeft(stage.seconds_left, stage.seconds_left_std));
  }
  return parts.join(", ");
}
