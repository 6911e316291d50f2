import type { Run, Stage } from "../client";

export type RunState = Run["state"];

export function isActive(state: RunState): boolean {
  return state === "queued" || state === "running";
}

/** Mantine colours of states; the word stands beside, so that colour alone says nothing. */
export const STATE_COLOURS: Record<string, string> = {
  queued: "gray",
  waiting: "gray",
  running: "cyan",
  completed: "teal",
  failed: "red",
  cancelled: "orange",
};

export const STAGE_TITLES: Record<string, string> = {
  ingest: "Reading frames",
  detect: "Finding droplets",
  track: "Tracking",
  analyse: "Statistics",
};

/** Share of a run that is done, 0 to 1: every frame of every stage counts the same. */
export function doneShare(stages: Pick<Stage, "done_frames" | "total_frames" | "state">[]): number {
  const total = stages.reduce((sum, { total_frames }) => sum + total_frames, 0);
  const done = stages.reduce(
    (sum, { state, done_frames, total_frames }) => sum + (state === "completed" ? total_frames : done_frames),
    0,
  );
  return total > 0 ? done / total : 0;
}
