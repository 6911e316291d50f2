import { Alert, Text } from "@mantine/core";
import type { Run } from "../client";
import { formatNumber } from "../platform/format";
import { numberAt } from "../runs/summary";

/** Which droplets the size distribution after tracking counts, where that is not all that were followed. */
export function HowCounted({ run }: { run: Run }) {
  if (!run.summary) return null;
  if (numberAt(run.summary, "tracked.n_counted") === null) {
    return (
      <Alert color="blue" role="status" mb="md" title="Counted frame by frame">
        An earlier version made this run: after tracking it counted every followed droplet, also those out of
        focus, with its radius in the single frame. A new run of the experiment counts those in focus with the
        radius of their whole trajectory; what is done is used again where it is the same.
      </Alert>
    );
  }
  const share = numberAt(run.summary, "tracked.out_of_focus_share") ?? 0;
  if (share === 0) return null;
  const tracking = run.parameters.tracking as { count_out_of_focus?: boolean } | undefined;
  return (
    <Text fz="sm" mb="sm">
      {formatNumber(100 * share, 2)} % of the droplets on trajectories are out of focus. They are followed
      {tracking?.count_out_of_focus ? ", and counted as the parameters say." : ", but not counted here."}
    </Text>
  );
}
