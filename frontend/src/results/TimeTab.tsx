import { Stack } from "@mantine/core";
import type { Run } from "../client";
import { Panel } from "../platform/Panel";
import { FigureView } from "./FigureView";
import { useSharedRanges } from "./view";

/** Numbers over time: moments of the sizes, mean and rms of the flow. They share their time axis. */
export function TimeTab({ run }: { run: Run }) {
  const { ranges, zoom } = useSharedRanges();
  const plot = { ranges, onRanges: zoom };
  return (
    <Stack gap="md">
      <Panel title="Sizes over time" about="Bands are one standard deviation of counting.">
        <FigureView
          run={run}
          name="moments"
          label="Moments of the size distribution over time"
          height={640}
          {...plot}
        />
      </Panel>
      <Panel title="Flow over time" about="Only cells that were computed from droplets count.">
        <FigureView
          run={run}
          name="flow_moments"
          label="Mean and rms flow over time"
          height={400}
          {...plot}
        />
      </Panel>
    </Stack>
  );
}
