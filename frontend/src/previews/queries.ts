import { queryOptions } from "@tanstack/react-query";
import { linkPreviewsCreate, previewsCreate, type Region } from "../client";
import type { Document } from "../forms/document";
import { ProblemError } from "../platform/problem";

const KEEP_MS = 60_000;

/** Workers that begin, or have much to do, are asked again; what is wrong stays wrong. */
export function isLate(n_failures: number, error: Error): boolean {
  return n_failures < 3 && error instanceof ProblemError && error.problem.code === "preview.late";
}

/** What detection finds with some parameters; without a region in the whole frame. */
export function previewQuery(
  experimentId: string,
  frame: number,
  parameters: Document,
  region: Region | null,
  is_picture_wanted = false,
) {
  const body = { frame, parameters, region, is_picture_wanted };
  return queryOptions({
    queryKey: ["experiments", experimentId, "preview", body],
    queryFn: async ({ signal }) =>
      (await previewsCreate({ path: { experiment_id: experimentId }, body, signal })).data,
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: KEEP_MS,
    retry: isLate,
  });
}

export function linkPreviewQuery(experimentId: string, frame: number, parameters: Document) {
  const body = { frame, parameters };
  return queryOptions({
    queryKey: ["experiments", experimentId, "preview", "links", body],
    queryFn: async ({ signal }) =>
      (await linkPreviewsCreate({ path: { experiment_id: experimentId }, body, signal })).data,
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: KEEP_MS,
    retry: isLate,
  });
}
