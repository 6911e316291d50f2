import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import {
  detectionsGet,
  dropletsGet,
  type FigureName,
  figuresGet,
  figuresList,
  flowGet,
  flowMapsGet,
  qualityGet,
  type Run,
  resultFilesList,
  tailsGet,
  trajectoriesGet,
} from "../client";
import { ProblemError } from "../platform/problem";
import { isLate } from "../previews/queries";
import { isActive } from "../runs/states";
import type { Asked } from "./asked";
import { type Availability, availability, stagesOf } from "./availability";
import type { Ranges } from "./figure";

/** What grows is asked for anew at this pace. */
const REFRESH_MS = 4_000;
const KEEP_MS = 60_000;

/** A result that is not there yet is an answer like any other: null. Nobody is asked for what cannot be there. */
async function orNotYet<Data>(
  available: Availability,
  ask: () => Promise<{ data: Data }>,
): Promise<Data | null> {
  if (available === "none") return null;
  try {
    return (await ask()).data;
  } catch (error) {
    if (error instanceof ProblemError && error.problem.code === "results.not_yet") return null;
    throw error;
  }
}

function freshness(available: Availability) {
  const isGrowing = available === "growing";
  return {
    staleTime: isGrowing ? 0 : Number.POSITIVE_INFINITY,
    refetchInterval: isGrowing ? REFRESH_MS : (false as const),
  };
}

export function figureQuery(run: Run, name: FigureName, query: Asked = {}) {
  const stages = stagesOf(name).map((stage) => availability(run, stage));
  const available = stages[0] ?? "none";
  return queryOptions({
    queryKey: ["runs", run.id, "figures", name, stages, query],
    queryFn: ({ signal }) =>
      orNotYet(available, () => figuresGet({ path: { run_id: run.id, name }, query, signal })),
    placeholderData: keepPreviousData,
    ...freshness(available),
  });
}

/** Which figures there are for a run; it follows the run while it goes. */
export function catalogueQuery(run: Run) {
  return queryOptions({
    queryKey: ["runs", run.id, "figures", run.stages.map(({ state }) => state)],
    queryFn: async ({ signal }) => (await figuresList({ path: { run_id: run.id }, signal })).data.items,
    placeholderData: keepPreviousData,
  });
}

export function dropletsQuery(run: Run, frame: number, which: "detected" | "tracked") {
  const available = availability(run, which === "tracked" ? "track" : "detect");
  const request = { path: { run_id: run.id, frame }, query: { which } };
  return queryOptions({
    queryKey: ["runs", run.id, "frames", frame, which, available],
    queryFn: ({ signal }) => orNotYet(available, () => dropletsGet({ ...request, signal })),
    gcTime: KEEP_MS,
    structuralSharing: false,
    ...freshness(available),
  });
}

/** A frame looked at once more as the run did: what was not taken for a droplet. */
export function detectionQuery(run: Run, frame: number) {
  return queryOptions({
    queryKey: ["runs", run.id, "frames", frame, "detection"],
    queryFn: async ({ signal }) => (await detectionsGet({ path: { run_id: run.id, frame }, signal })).data,
    gcTime: KEEP_MS,
    staleTime: Number.POSITIVE_INFINITY,
    structuralSharing: false,
    retry: isLate,
  });
}

export function flowQuery(run: Run, frame: number) {
  const available = availability(run, "track");
  return queryOptions({
    queryKey: ["runs", run.id, "frames", frame, "flow", available],
    queryFn: ({ signal }) => orNotYet(available, () => flowGet({ path: { run_id: run.id, frame }, signal })),
    gcTime: KEEP_MS,
    structuralSharing: false,
    ...freshness(available),
  });
}

export function tailsQuery(run: Run, frame: number, n_frames: number) {
  const available = availability(run, "track");
  const request = { path: { run_id: run.id, frame }, query: { n_frames } };
  return queryOptions({
    queryKey: ["runs", run.id, "frames", frame, "tails", n_frames, available],
    queryFn: ({ signal }) => orNotYet(available, () => tailsGet({ ...request, signal })),
    gcTime: KEEP_MS,
    structuralSharing: false,
    ...freshness(available),
  });
}

/** The flow of one step, or averaged over a range of time. */
export function flowMapQuery(run: Run, when: { frame?: number; from_s?: number; to_s?: number }) {
  const available = availability(run, "track");
  return queryOptions({
    queryKey: ["runs", run.id, "flow_map", when, available],
    queryFn: ({ signal }) =>
      orNotYet(available, () => flowMapsGet({ path: { run_id: run.id }, query: when, signal })),
    gcTime: KEEP_MS,
    structuralSharing: false,
    ...freshness(available),
  });
}

export function qualityQuery(run: Run, { time_s, radius_um }: Ranges) {
  const available = availability(run, "track");
  const query = {
    ...{ from_s: time_s?.[0], to_s: time_s?.[1] },
    ...{ radius_min_um: radius_um?.[0], radius_max_um: radius_um?.[1] },
  };
  return queryOptions({
    queryKey: ["runs", run.id, "quality", query, available],
    queryFn: ({ signal }) =>
      orNotYet(available, () => qualityGet({ path: { run_id: run.id }, query, signal })),
    ...freshness(available),
  });
}

export function trajectoryQuery(run: Run, trajectoryId: number) {
  const path = { run_id: run.id, trajectory_id: trajectoryId };
  return queryOptions({
    queryKey: ["runs", run.id, "trajectories", trajectoryId],
    queryFn: async ({ signal }) => (await trajectoriesGet({ path, signal })).data,
    staleTime: Number.POSITIVE_INFINITY,
  });
}

export function resultFilesQuery(run: Run) {
  const isOver = !isActive(run.state);
  return queryOptions({
    queryKey: ["runs", run.id, "files", isOver],
    queryFn: async ({ signal }) => (await resultFilesList({ path: { run_id: run.id }, signal })).data.items,
    refetchInterval: isOver ? false : REFRESH_MS,
  });
}
