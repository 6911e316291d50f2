import { Progress, Stack, Text } from "@mantine/core";
import type { Usage } from "../client";
import { formatBytes } from "../platform/format";

/** How much of the disk and of the workers a group uses, of what it may use. */
export function UsageBar({ usage }: { usage: Usage }) {
  const { used_bytes, max_bytes, n_active_runs, max_active_runs } = usage;
  return (
    <Stack gap={4}>
      <Text fz="sm">
        {formatBytes(used_bytes)}
        {max_bytes !== null && ` of ${formatBytes(max_bytes)}`} used, {n_active_runs}
        {max_active_runs !== null && ` of ${max_active_runs}`} {n_active_runs === 1 ? "run" : "runs"} going on
      </Text>
      {max_bytes !== null && (
        <Progress
          value={max_bytes === 0 ? 100 : Math.min(100, (100 * used_bytes) / max_bytes)}
          color={used_bytes > 0.9 * max_bytes ? "orange" : undefined}
          aria-label="Room used"
        />
      )}
    </Stack>
  );
}
