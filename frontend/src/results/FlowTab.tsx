import { Group, Text } from "@mantine/core";
import { keepPreviousData, useQuery, useQueryClient } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { useEffect, useMemo } from "react";
import type { Experiment, FrameDroplets, Run } from "../client";
import { FramePlayer } from "../frames/FramePlayer";
import { neighbours } from "../frames/pictures";
import { frameSource, timeOfFrame } from "../frames/source";
import { formatNumber, plural } from "../platform/format";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { type ArrowField, arrowsOf } from "./arrows";
import { availability } from "./availability";
import { LayerSwitches } from "./LayerSwitches";
import { NotYet } from "./NotYet";
import { overlayPainter } from "./overlay";
import { dropletsQuery, flowQuery } from "./queries";
import type { Layer } from "./view";

const route = getRouteApi("/runs/$runId");

/** Frame by frame: the droplets, where they go, and the flow. */
export function FlowTab({ run, experiment }: { run: Run; experiment: Experiment }) {
  const { frame = 0, hide = [] } = route.useSearch();
  const navigate = route.useNavigate();
  const source = useMemo(() => frameSource(experiment), [experiment]);
  const shown = Math.min(frame, (source?.n_frames ?? 1) - 1);
  const { droplets, field, error, isThere } = useFrameResults(run, shown, source?.n_frames ?? 1);
  const paint = useMemo(
    () => overlayPainter({ droplets, field }, (layer) => !hide.includes(layer)),
    [droplets, field, hide],
  );
  if (!source) return <NotYet run={run} />;

  const toggle = (layer: Layer) => {
    const next = hide.includes(layer) ? hide.filter((one) => one !== layer) : [...hide, layer];
    void navigate({
      search: (old) => ({ ...old, hide: next.length > 0 ? next : undefined }),
      replace: true,
      resetScroll: false,
    });
  };

  return (
    <Panel
      title="Droplets and flow"
      about={describe(droplets, shown)}
      actions={field && <ArrowKey field={field} />}
    >
      <LayerSwitches hidden={hide} onToggle={toggle} />
      {error && <ProblemAlert problem={toProblem(error)} />}
      <FramePlayer
        source={source}
        frame={shown}
        onFrame={(to) =>
          navigate({ search: (old) => ({ ...old, frame: to }), replace: true, resetScroll: false })
        }
        paint={paint}
        label={`Frame ${shown} with droplets and flow. ${describe(droplets, shown)}`}
        time={timeOfFrame(experiment, shown)}
      />
      {isThere && !droplets && <NotYet run={run} />}
      <Text fz="xs" c="dimmed">
        Keys: arrows step one frame, with Shift ten; Home and End go to the first and last; the space bar
        plays.
      </Text>
    </Panel>
  );
}

/** What a run knows of one frame; the droplets of detection stand in until tracking is through. */
function useFrameResults(run: Run, frame: number, n_frames: number) {
  const cache = useQueryClient();
  const isTracked = availability(run, "track") === "whole";
  const which = isTracked ? "tracked" : "detected";
  const droplets = useQuery({ ...dropletsQuery(run, frame, which), placeholderData: keepPreviousData });
  const flow = useQuery({ ...flowQuery(run, frame), placeholderData: keepPreviousData });
  useEffect(() => {
    if (!isTracked) return;
    for (const near of neighbours(frame, n_frames)) {
      void cache.prefetchQuery(dropletsQuery(run, near, "tracked"));
      void cache.prefetchQuery(flowQuery(run, near));
    }
  }, [run, frame, n_frames, isTracked, cache]);
  const field = useMemo(() => (flow.data ? arrowsOf(flow.data) : null), [flow.data]);
  return {
    droplets: droplets.data ?? null,
    field,
    error: droplets.error ?? flow.error,
    isThere: !droplets.isPending,
  };
}

function describe(droplets: FrameDroplets | null, frame: number): string {
  if (!droplets) return "";
  const n = droplets.x_px.length;
  if (!droplets.is_detected) return `${plural(n, "droplet")} detected in frame ${frame}.`;
  const n_predicted = droplets.is_detected.filter((isDetected) => !isDetected).length;
  const n_going_on = droplets.next_x_px?.filter((x) => x != null).length ?? 0;
  const found = n_predicted > 0 ? `, ${n_predicted} of them found by prediction (dashed)` : "";
  return `${plural(n, "droplet")} on trajectories in frame ${frame}${found}; ${n_going_on} go on to the next frame.`;
}

/** How fast an arrow of what length is. */
function ArrowKey({ field }: { field: ArrowField }) {
  return (
    <Group gap={6} wrap="nowrap">
      <svg width="44" height="12" aria-hidden="true">
        <path
          d="M2 6H40M33 2l7 4-7 4"
          fill="none"
          stroke="currentColor"
          strokeWidth="1.6"
          strokeLinecap="round"
        />
      </svg>
      <Text fz="sm" c="dimmed" className="numbers">
        {formatNumber(field.key_um_s)} µm/s: {formatNumber(field.key_px, 2)} px
      </Text>
    </Group>
  );
}
