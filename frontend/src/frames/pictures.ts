import { keepPreviousData, queryOptions, useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { apiUrl } from "../platform/base";
import { ProblemError, problemFromAnswer } from "../platform/problem";

/** What must be known of a stack to show its frames. */
export type FrameSource = {
  experimentId: string;
  n_frames: number;
  rows: number;
  columns: number;
  /** Checksum of the frames: with it the browser may keep a picture for ever. */
  checksum: string | null;
};

/** Sides that pictures are asked for, so that nearby window sizes share them in the browser's cache. */
const SIDES_PX = [600, 1200, 2400];
/** Decoded pictures are large: those that nobody looks at go soon; the browser's cache keeps the bytes. */
const KEEP_MS = 4_000;
const N_AHEAD = 2;

export function sideFor(width_px: number): number {
  return SIDES_PX.find((side) => side >= width_px * 0.9) ?? (SIDES_PX.at(-1) as number);
}

export function pictureQuery({ experimentId, checksum }: FrameSource, frame: number, max_side: number) {
  const url = apiUrl(["experiments", experimentId, "frames", `${frame}.webp`], {
    max_side,
    v: checksum ?? undefined,
  });
  return queryOptions({
    queryKey: ["picture", url],
    queryFn: async ({ signal }) => {
      const answer = await fetch(url, { signal });
      if (!answer.ok) {
        throw new ProblemError(
          problemFromAnswer(await answer.json().catch(() => null), answer.status, answer.statusText),
        );
      }
      return createImageBitmap(await answer.blob());
    },
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: KEEP_MS,
    structuralSharing: false,
  });
}

/** The picture of a frame; until it is there, the one before stays. Its neighbours are fetched ahead. */
export function usePicture(source: FrameSource, frame: number, max_side: number) {
  const cache = useQueryClient();
  const query = useQuery({ ...pictureQuery(source, frame, max_side), placeholderData: keepPreviousData });
  const isThere = query.isSuccess && !query.isPlaceholderData;
  useEffect(() => {
    if (!isThere) return;
    for (const near of neighbours(frame, source.n_frames))
      void cache.prefetchQuery(pictureQuery(source, near, max_side));
  }, [isThere, frame, max_side, source, cache]);
  return query;
}

/** Frames worth having next: forward first. */
export function neighbours(frame: number, n_frames: number): number[] {
  const steps = Array.from({ length: N_AHEAD }, (_, index) => index + 1);
  return [...steps.map((step) => frame + step), frame - 1].filter((near) => near >= 0 && near < n_frames);
}
