import { type QueryClient, useQueryClient } from "@tanstack/react-query";
import { useEffect, useRef } from "react";
import type { Experiment, Run } from "../client";
import { pictureQuery, sideFor } from "../frames/pictures";
import { frameSource } from "../frames/source";
import { whenIdle } from "../platform/later";
import { isFollowed } from "./frameResults";
import { dropletsQuery, flowMapQuery, flowQuery } from "./queries";

const LOOK_AGAIN_MS = 250;

/**
 * The frame that the other tabs begin with, small, and what is shown over it: asked for once nothing else is. The first
 * look at a long film is slow, for the service opens its frames and tables then; so nobody waits for it.
 */
export function useFrameAhead(run: Run, experiment: Experiment | undefined, frame: number): void {
  const cache = useQueryClient();
  const first = useRef(frame);
  useEffect(() => {
    if (run.state !== "completed" || !experiment) return;
    return onceQuiet(cache, () => ask(cache, run, experiment, first.current));
  }, [cache, run, experiment]);
}

function ask(cache: QueryClient, run: Run, experiment: Experiment, frame: number): void {
  const source = frameSource(experiment);
  if (!source || frame >= source.n_frames) return;
  void cache.prefetchQuery(pictureQuery(source, frame, sideFor(1)));
  if (!isFollowed(run, source.n_frames) || frame >= source.n_frames - 1) return;
  void cache.prefetchQuery(flowMapQuery(run, { frame }));
  void cache.prefetchQuery(dropletsQuery(run, frame, "tracked"));
  void cache.prefetchQuery(flowQuery(run, frame));
}

/** When the page has nothing to do and waits for nothing. */
function onceQuiet(cache: QueryClient, act: () => void): () => void {
  let isWanted = true;
  const look = () => {
    if (!isWanted) return;
    if (cache.isFetching() === 0) act();
    else setTimeout(() => whenIdle(look), LOOK_AGAIN_MS);
  };
  setTimeout(() => whenIdle(look), LOOK_AGAIN_MS);
  return () => {
    isWanted = false;
  };
}
