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
  pixel_size_um: number;
  /** Checksum of the frames: with it the browser may keep a picture for ever. */
  checksum: string | null;
  /** The run as whose detection saw them they are shown; without it as they came. */
  preparedIn?: string;
};

/** Sides that pictures are asked for, so that nearby window sizes share them in the browser's cache. */
const SIDES_PX = [600, 1200];
/** Above these the whole frame as it is: the service makes it as quickly. */
const WHOLE_PX = 8192;
/** Decoded pictures are large: those that nobody looks at go soon; the browser's cache keeps the bytes. */
const KEEP_MS = 4_000;
const N_AHEAD = 3;

export function sideFor(width_px: number): number {
  return SIDES_PX.find((side) => side >= width_px * 0.9) ?? WHOLE_PX;
}

export async function fetchPicture(url: string, signal?: AbortSignal): Promise<ImageBitmap> {
  const answer = await fetch(url, { signal });
  if (!answer.ok) {
    const body = await answer.json().catch(() => null);
    throw new ProblemError(problemFromAnswer(body, answer.status, answer.statusText));
  }
  return createImageBitmap(await answer.blob());
}

export function pictureUrl(source: FrameSource, frame: number, max_side: number): string {
  const { experimentId, checksum, preparedIn } = source;
  if (preparedIn) return apiUrl(["runs", preparedIn, "frames", String(frame), "prepared.jpg"]);
  const query = { max_side, v: checksum ?? undefined };
  return apiUrl(["experiments", experimentId, "frames", `${frame}.jpg`], query);
}

/** The frame with all of its pixels. */
export function wholePictureUrl(source: FrameSource, frame: number): string {
  return pictureUrl(source, frame, WHOLE_PX);
}

export function pictureQuery(source: FrameSource, frame: number, max_side: number) {
  const url = pictureUrl(source, frame, max_side);
  return queryOptions({
    queryKey: ["picture", url],
    queryFn: ({ signal }) => fetchPicture(url, signal),
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: KEEP_MS,
    structuralSharing: false,
  });
}

/**
 * The picture of a frame `width_px` wide; until it is there, the one before stays. Its neighbours are fetched ahead,
 * once the width is known.
 */
export function usePicture(source: FrameSource, frame: number, width_px: number) {
  const max_side = sideFor(width_px);
  const isMeasured = width_px > 0;
  const cache = useQueryClient();
  const query = useQuery({ ...pictureQuery(source, frame, max_side), placeholderData: keepPreviousData });
  const isThere = query.isSuccess && !query.isPlaceholderData;
  useEffect(() => {
    if (!isThere || !isMeasured) return;
    for (const near of neighbours(frame, source.n_frames))
      void cache.prefetchQuery(pictureQuery(source, near, max_side));
  }, [isThere, isMeasured, frame, max_side, source, cache]);
  return query;
}

/** Frames worth having next: forward first. */
export function neighbours(frame: number, n_frames: number): number[] {
  const steps = Array.from({ length: N_AHEAD }, (_, index) => index + 1);
  return [...steps.map((step) => frame + step), frame - 1].filter((near) => near >= 0 && near < n_frames);
}
