import { Button, Group, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { type CSSProperties, useMemo } from "react";
import type { FigureEntry, FigureName, Run } from "../client";
import { formatNumber } from "../platform/format";
import { Panel } from "../platform/Panel";
import { Loading, QueryView } from "../platform/QueryView";
import type { Asked } from "./asked";
import { FigureCard, PaperAndTable } from "./FigureCard";
import type { Mark, Range } from "./figure";
import { COLOUR_BAR_PX } from "./fitting";
import { HowCounted } from "./HowCounted";
import { NotYet } from "./NotYet";
import { useTimeAxis } from "./oscillations";
import { Plot } from "./Plot";
import { catalogueQuery, figureQuery } from "./queries";
import { useTogether } from "./together";
import { useSharedRanges, useView } from "./view";

const HEIGHT = 440;

/** The size distribution over time before and after tracking; a zoom in one is a zoom in both. */
export function SizesTab({ run }: { run: Run }) {
  const { ranges, zoom, clear } = useSharedRanges();
  const { search, change } = useView();
  const { aligned_s, marks } = useTimeAxis(run, search.marks !== false);
  const { at } = search;
  const shownMarks = useMemo(
    (): readonly Mark[] => (at === undefined ? marks : [...marks, { time_s: at, kind: "chosen" }]),
    [marks, at],
  );
  const around = at === undefined ? undefined : aroundMoment(at, ranges.time_s ?? aligned_s);
  const finer = useMemo(() => ({ from_s: ranges.time_s?.[0], to_s: ranges.time_s?.[1] }), [ranges.time_s]);
  const before = useQuery(figureQuery(run, "size_distribution_before", finer));
  const after = useQuery(figureQuery(run, "size_distribution_after", finer));
  const catalogue = useQuery(catalogueQuery(run));
  const entryOf = (name: FigureName) => catalogue.data?.find((entry) => entry.name === name);
  const slice = entryOf("size_distribution_at");
  const [left, right] = useTogether(before, after);
  const plot = {
    height: HEIGHT,
    ranges,
    onRanges: zoom,
    marks: shownMarks,
    onMoment: (time_s: number) => change({ at: Number(time_s.toPrecision(8)) }),
  };
  return (
    <Stack gap="md">
      <Panel
        title="Droplet size distribution"
        about="Droplets per radius over time, on a logarithmic scale. Tracking takes out what appears only once or does not move as droplets do. Draw a rectangle to look closer; click a moment to see its distribution below."
        actions={
          (ranges.time_s || ranges.radius_um) && (
            <Button size="compact-sm" variant="default" onClick={clear}>
              Show everything
            </Button>
          )
        }
      >
        <HowCounted run={run} />
        <div className="side-by-side" style={{ "--colour-bar": `${COLOUR_BAR_PX}px` } as CSSProperties}>
          <div>
            <MapTitle run={run} entry={entryOf("size_distribution_before")} asked={finer}>
              Before tracking
            </MapTitle>
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
          <div>
            <MapTitle run={run} entry={entryOf("size_distribution_after")} asked={finer}>
              After tracking
            </MapTitle>
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
      {around && (
        <Group gap="sm">
          <Text fz="sm">
            Below: the distribution from {formatNumber(around[0])} to {formatNumber(around[1])} s, where the
            blue line stands.
          </Text>
          <Button size="compact-sm" variant="default" onClick={() => change({ at: undefined })}>
            Of all times that are shown
          </Button>
        </Group>
      )}
      {slice && (
        <FigureCard
          run={run}
          entry={slice}
          ranges={ranges}
          onRanges={zoom}
          more={around && { from_s: around[0], to_s: around[1] }}
          height={360}
        />
      )}
    </Stack>
  );
}

type MapTitleProps = { run: Run; entry: FigureEntry | undefined; asked: Asked; children: string };

function MapTitle({ run, entry, asked, children }: MapTitleProps) {
  return (
    <Group justify="space-between" mb={4} mih={28}>
      <Text fw={500} fz="sm">
        {children}
      </Text>
      {entry && <PaperAndTable run={run} entry={entry} asked={asked} />}
    </Group>
  );
}

/** A moment is a fiftieth of what is shown wide: enough droplets for a curve, little enough to be one moment. */
function aroundMoment(at_s: number, shown_s: Range | undefined): Range {
  const half_s = shown_s ? (shown_s[1] - shown_s[0]) / 100 : 1;
  return [Number((at_s - half_s).toPrecision(9)), Number((at_s + half_s).toPrecision(9))];
}
