import { queryOptions } from "@tanstack/react-query";
import { linkPreviewsCreate, previewsCreate, type Region } from "../client";
import type { Document } from "../forms/document";

const KEEP_MS = 60_000;

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
    retry: false,
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
    retry: false,
  });
}
