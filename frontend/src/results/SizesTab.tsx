import { Button, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { type CSSProperties, useMemo } from "react";
import type { Run } from "../client";
import { Panel } from "../platform/Panel";
import { Loading, QueryView } from "../platform/QueryView";
import { FigureCard } from "./FigureCard";
import { COLOUR_BAR_PX, type Figure, withCommonColours } from "./figure";
import { NotYet } from "./NotYet";
import { Plot } from "./Plot";
import { catalogueQuery, figureQuery } from "./queries";
import { useSharedRanges } from "./view";

const HEIGHT = 440;

/** The size distribution over time before and after tracking; a zoom in one is a zoom in both. */
export function SizesTab({ run }: { run: Run }) {
  const { ranges, zoom, clear } = useSharedRanges();
  const finer = useMemo(() => ({ from_s: ranges.time_s?.[0], to_s: ranges.time_s?.[1] }), [ranges.time_s]);
  const before = useQuery(figureQuery(run, "size_distribution_before", finer));
  const after = useQuery(figureQuery(run, "size_distribution_after", finer));
  const catalogue = useQuery(catalogueQuery(run));
  const slice = catalogue.data?.find(({ name }) => name === "size_distribution_at");
  const [left, right] = useMemo(
    () => withCommonColours((before.data ?? null) as Figure | null, (after.data ?? null) as Figure | null),
    [before.data, after.data],
  );
  const plot = {
    height: HEIGHT,
    ranges,
    onRanges: zoom,
  };
  return (
    <Stack gap="md">
      <Panel
        title="Droplet size distribution"
        about="Droplets per radius over time, on a logarithmic scale. Tracking takes out what appears only once or does not move as droplets do."
        actions={
          (ranges.time_s || ranges.radius_um) && (
            <Button size="compact-sm" variant="default" onClick={clear}>
              Show everything
            </Button>
          )
        }
      >
        <div className="side-by-side">
          <div>
            <Text fw={500} fz="sm" mb={4}>
              Before tracking
            </Text>
            <QueryView query={before} loading={<Loading rows={1} height={HEIGHT} />}>
              {() =>
                left ? (
                  <Plot figure={left} label="Size distribution before tracking" {...plot} />
                ) : (
                  <NotYet run={run} />
                )
              }
            </QueryView>
          </div>
          {/* Wider by the colour bar, so that both time axes are of one length. */}
          <div style={{ "--wider-by": `${COLOUR_BAR_PX}px` } as CSSProperties}>
            <Text fw={500} fz="sm" mb={4}>
              After tracking
            </Text>
            <QueryView query={after} loading={<Loading rows={1} height={HEIGHT} />}>
              {() =>
                right ? (
                  <Plot figure={right} label="Size distribution after tracking" {...plot} />
                ) : (
                  <NotYet run={run} />
                )
              }
            </QueryView>
          </div>
        </div>
      </Panel>
      {slice && <FigureCard run={run} entry={slice} ranges={ranges} onRanges={zoom} height={360} />}
    </Stack>
  );
}
