import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { dropletsGet, type FigureName, figuresGet, flowGet, resultFilesList } from "../client";
import { ProblemError } from "../platform/problem";
import { isWorthRetrying } from "../platform/queryClient";

/** Results of a run that goes on are asked for anew at this pace. */
export const REFRESH_MS = 4_000;
const KEEP_MS = 60_000;

/** A result that is not there yet is an answer like any other: null. */
async function orNotYet<Data>(asked: Promise<{ data: Data }>): Promise<Data | null> {
  try {
    return (await asked).data;
  } catch (error) {
    if (error instanceof ProblemError && error.problem.code === "results.not_yet") return null;
    throw error;
  }
}

/** `version` changes when there is more to see: results of a run that ended are asked for once. */
export function figureQuery(runId: string, name: FigureName, isOver: boolean) {
  return queryOptions({
    queryKey: ["runs", runId, "figures", name, isOver],
    queryFn: ({ signal }) => orNotYet(figuresGet({ path: { run_id: runId, name }, signal })),
    staleTime: isOver ? Number.POSITIVE_INFINITY : 0,
    refetchInterval: isOver ? false : REFRESH_MS,
    placeholderData: keepPreviousData,
    retry: isWorthRetrying,
  });
}

export function dropletsQuery(runId: string, frame: number, which: "detected" | "tracked", isOver: boolean) {
  return queryOptions({
    queryKey: ["runs", runId, "frames", frame, which, isOver],
    queryFn: ({ signal }) =>
      orNotYet(dropletsGet({ path: { run_id: runId, frame }, query: { which }, signal })),
    staleTime: isOver ? Number.POSITIVE_INFINITY : 0,
    refetchInterval: isOver ? false : REFRESH_MS,
    gcTime: KEEP_MS,
    structuralSharing: false,
  });
}

export function flowQuery(runId: string, frame: number, isOver: boolean) {
  return queryOptions({
    queryKey: ["runs", runId, "frames", frame, "flow", isOver],
    queryFn: ({ signal }) => orNotYet(flowGet({ path: { run_id: runId, frame }, signal })),
    staleTime: isOver ? Number.POSITIVE_INFINITY : 0,
    refetchInterval: isOver ? false : REFRESH_MS,
    gcTime: KEEP_MS,
    structuralSharing: false,
  });
}

export function resultFilesQuery(runId: string, isOver: boolean) {
  return queryOptions({
    queryKey: ["runs", runId, "files", isOver],
    queryFn: async ({ signal }) => (await resultFilesList({ path: { run_id: runId }, signal })).data.items,
    refetchInterval: isOver ? false : REFRESH_MS,
  });
}
