import { Group, SegmentedControl, Select, Stack, Text } from "@mantine/core";
import { keepPreviousData, useQuery, useQueryClient } from "@tanstack/react-query";
import { useCallback, useEffect, useMemo } from "react";
import type { Experiment, FlowMap, Run } from "../client";
import { FramePlayer } from "../frames/FramePlayer";
import type { Painter } from "../frames/pen";
import { neighbours } from "../frames/pictures";
import { frameSource, useStamp } from "../frames/source";
import { viewFromText, viewToText } from "../frames/viewport";
import { formatCount, formatNumber } from "../platform/format";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { arrowsOf } from "./arrows";
import { FigureView } from "./FigureView";
import { ArrowKey } from "./FramesTab";
import {
  colourAt,
  fieldOfMap,
  type MapScale,
  mapPainter,
  mapScale,
  QUANTITIES,
  type Quantity,
  quantityOf,
} from "./maps";
import { NotYet } from "./NotYet";
import { overlayPainter } from "./overlay";
import { flowMapQuery } from "./queries";
import { useSharedRanges, useView } from "./view";

const OF_A_STEP: Quantity[] = ["speed", "vorticity", "divergence"];
const OF_A_RANGE: Quantity[] = ["speed", "rms", "vorticity", "divergence", "computed"];

/** The flow field: step by step or averaged over a range of time, and its moments over time. */
export function FlowTab({ run, experiment }: { run: Run; experiment: Experiment }) {
  const { ranges, zoom } = useSharedRanges();
  return (
    <Stack gap="md">
      <FlowField run={run} experiment={experiment} />
      <Panel
        title="Flow over time"
        about="Mean and rms of the cells that were computed from droplets. Draw over a part to look at it everywhere."
      >
        <FigureView
          run={run}
          name="flow_moments"
          label="Mean and rms flow over time"
          height={340}
          ranges={ranges}
          onRanges={zoom}
        />
      </Panel>
    </Stack>
  );
}

function FlowField({ run, experiment }: { run: Run; experiment: Experiment }) {
  const { search, change } = useView();
  const { ranges } = useSharedRanges();
  const cache = useQueryClient();
  const source = useMemo(() => frameSource(experiment), [experiment]);
  const stamp = useStamp(experiment);
  const n_steps = Math.max(1, (source?.n_frames ?? 2) - 1);
  const isMean = search.mean === true;
  const frame = Math.min(search.frame ?? 0, n_steps - 1);
  const when = isMean ? { from_s: ranges.time_s?.[0], to_s: ranges.time_s?.[1] } : { frame };
  const query = useQuery({ ...flowMapQuery(run, when), placeholderData: keepPreviousData });
  const map = query.data ?? null;
  const quantity = quantityOf(search.map);
  const isOffered = quantity !== undefined && (isMean ? OF_A_RANGE : OF_A_STEP).includes(quantity);
  const shown = isOffered ? quantity : undefined;
  const isThere = !query.isPending && !query.isPlaceholderData;
  useEffect(() => {
    if (isMean || !isThere) return;
    for (const near of neighbours(frame, n_steps))
      void cache.prefetchQuery(flowMapQuery(run, { frame: near }));
  }, [isMean, isThere, frame, n_steps, run, cache]);
  const { paint, scale, field } = useMemo(() => flowPainter(map, shown), [map, shown]);
  const sceneryOf = useCallback(
    async (which: number) => ({
      paint: flowPainter(await cache.fetchQuery(flowMapQuery(run, { frame: which })), shown).paint,
    }),
    [cache, run, shown],
  );
  if (!source) return <NotYet run={run} />;

  return (
    <Panel
      title="Flow field"
      about={map ? describe(map, isMean) : ""}
      actions={field && <ArrowKey field={field} />}
    >
      {query.error && <ProblemAlert problem={toProblem(query.error)} />}
      {query.isSuccess && !map ? (
        <NotYet run={run} />
      ) : (
        <FramePlayer
          source={{ ...source, n_frames: n_steps }}
          frame={isMean ? (map?.first_frame ?? 0) : frame}
          onFrame={(to) => change({ frame: to })}
          isStill={isMean}
          paint={paint}
          sceneryOf={isMean ? undefined : sceneryOf}
          label={`Flow field. ${map ? describe(map, isMean) : ""}`}
          timeOf={isMean ? undefined : stamp}
          view={viewFromText(search.view)}
          onView={(next) => change({ view: viewToText(next) })}
          fileName={`${String(experiment.experiment.name)}-run-${run.number}-flow`}
          beside={
            <Group gap="sm">
              <SegmentedControl
                size="xs"
                aria-label="Which part of the film"
                value={isMean ? "mean" : "step"}
                onChange={(value) => change({ mean: value === "mean" ? true : undefined })}
                data={[
                  { value: "step", label: "Step by step" },
                  { value: "mean", label: ranges.time_s ? "Mean of the range" : "Mean of the film" },
                ]}
              />
              <Select
                size="xs"
                w={150}
                aria-label="Below the arrows"
                allowDeselect={false}
                value={shown ?? "frame"}
                onChange={(value) => change({ map: value === "frame" ? undefined : (value ?? undefined) })}
                data={[
                  { value: "frame", label: "Frame" },
                  ...(isMean ? OF_A_RANGE : OF_A_STEP).map((value) => ({
                    value,
                    label: QUANTITIES[value].title,
                  })),
                ]}
              />
              {shown && scale && <MapKey quantity={shown} scale={scale} />}
            </Group>
          }
        />
      )}
    </Panel>
  );
}

function flowPainter(map: FlowMap | null, quantity: Quantity | undefined) {
  const field = map && arrowsOf(fieldOfMap(map));
  const scale = map && quantity ? mapScale(map[QUANTITIES[quantity].field], quantity) : null;
  const below = map && quantity && scale ? mapPainter(map, quantity, scale) : null;
  const arrows = overlayPainter({ droplets: null, field, isOverMap: below !== null }, () => true);
  const paint: Painter = (pen, zoom) => {
    below?.(pen, zoom);
    arrows(pen, zoom);
  };
  return { paint, scale, field };
}

function MapKey({ quantity, scale }: { quantity: Quantity; scale: MapScale }) {
  const steps = Array.from({ length: 9 }, (_, step) => colourAt(step / 8, scale.isSigned));
  return (
    <Group gap={6} wrap="nowrap">
      <Text fz="xs" className="numbers">
        {formatNumber(scale.low, 2)}
      </Text>
      <span
        aria-hidden
        className="colour-bar"
        style={{ backgroundImage: `linear-gradient(90deg, ${steps.join()})` }}
      />
      <Text fz="xs" className="numbers" style={{ whiteSpace: "nowrap" }}>
        {formatNumber(scale.high, 2)} {QUANTITIES[quantity].unit}
      </Text>
    </Group>
  );
}

function describe(map: FlowMap, isMean: boolean): string {
  const cells = map.computed_share.flat();
  const share = cells.reduce((sum: number, cell) => sum + (cell ?? 0), 0) / Math.max(1, cells.length);
  const from = `${Math.round(100 * share)} % of the cells computed from droplets, the others interpolated (thin).`;
  if (!isMean) return `From frame ${formatCount(map.first_frame)} to the next. ${from}`;
  const sample = map.n_used < map.n_steps ? ` (${formatCount(map.n_used)} evenly chosen ones)` : "";
  return `Mean of ${formatCount(map.n_steps)} steps${sample}, ${formatNumber(map.from_s)} to ${formatNumber(map.to_s)} s; only what was computed from droplets.`;
}
