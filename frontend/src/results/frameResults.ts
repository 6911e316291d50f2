import { keepPreviousData, useQuery, useQueryClient } from "@tanstack/react-query";
import { useCallback, useEffect, useMemo } from "react";
import type { Run } from "../client";
import type { Scenery } from "../frames/drawing";
import type { Painter } from "../frames/pen";
import { neighbours } from "../frames/pictures";
import { arrowsOf } from "./arrows";
import { availability } from "./availability";
import type { OverlayData } from "./overlay";
import { detectionQuery, dropletsQuery, flowQuery, tailsQuery } from "./queries";
import type { Layer } from "./view";

const N_TAIL_FRAMES = 15;

/** Whether droplets are shown as trajectories know them: those of a frame that stands alone are on none. */
export function isFollowed(run: Run, n_frames: number): boolean {
  return n_frames > 1 && availability(run, "track") === "whole";
}

/** What a run knows of one frame; the droplets of detection stand in until tracking is through. */
export function useFrameResults(run: Run, frame: number, n_frames: number, layers: readonly Layer[]) {
  const cache = useQueryClient();
  const isTracked = isFollowed(run, n_frames);
  const which = isTracked ? "tracked" : "detected";
  const hasTails = isTracked && layers.includes("tails");
  const droplets = useQuery({ ...dropletsQuery(run, frame, which), placeholderData: keepPreviousData });
  const flow = useQuery({ ...flowQuery(run, frame), placeholderData: keepPreviousData });
  const tails = useQuery({
    ...tailsQuery(run, frame, N_TAIL_FRAMES),
    enabled: hasTails,
    placeholderData: keepPreviousData,
  });
  // The neighbours wait for what is looked at: the service answers one after the other.
  const isWhole = [droplets, flow, ...(hasTails ? [tails] : [])].every(
    ({ isPending, isPlaceholderData }) => !isPending && !isPlaceholderData,
  );
  useEffect(() => {
    if (!isTracked || !isWhole) return;
    for (const near of neighbours(frame, n_frames)) {
      void cache.prefetchQuery(dropletsQuery(run, near, "tracked"));
      void cache.prefetchQuery(flowQuery(run, near));
      if (hasTails) void cache.prefetchQuery(tailsQuery(run, near, N_TAIL_FRAMES));
    }
  }, [run, frame, n_frames, isTracked, hasTails, isWhole, cache]);
  const field = useMemo(() => (flow.data ? arrowsOf(flow.data) : null), [flow.data]);
  return {
    droplets: droplets.data ?? null,
    field,
    tails: hasTails ? (tails.data ?? null) : null,
    error: droplets.error ?? flow.error ?? tails.error,
    isThere: !droplets.isPending,
  };
}

/** Another look at the frame, where rejected candidates are wanted: they are not kept. */
export function useSecondLook(run: Run, frame: number, isRejectedWanted: boolean) {
  const query = useQuery({ ...detectionQuery(run, frame), enabled: isRejectedWanted });
  return {
    found: query.data ?? null,
    rejected: isRejectedWanted ? (query.data?.rejected ?? null) : null,
    error: query.error,
    isFetching: query.isFetching,
  };
}

/** What is drawn over any frame, for films. */
export function useSceneryOf(
  run: Run,
  n_frames: number,
  layers: readonly Layer[],
  dress: (data: OverlayData) => Painter,
) {
  const cache = useQueryClient();
  return useCallback(
    async (frame: number): Promise<Scenery> => {
      const isTracked = isFollowed(run, n_frames);
      const [droplets, flow, tails, look] = await Promise.all([
        cache.fetchQuery(dropletsQuery(run, frame, isTracked ? "tracked" : "detected")),
        cache.fetchQuery(flowQuery(run, frame)),
        layers.includes("tails") ? cache.fetchQuery(tailsQuery(run, frame, N_TAIL_FRAMES)) : null,
        layers.includes("rejected") ? cache.fetchQuery(detectionQuery(run, frame)) : null,
      ]);
      const field = flow && arrowsOf(flow);
      return { paint: dress({ droplets, field, tails, rejected: look?.rejected }) };
    },
    [cache, run, n_frames, layers, dress],
  );
}
