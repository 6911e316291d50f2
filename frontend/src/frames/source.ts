import type { Experiment } from "../client";
import { formatDuration } from "../platform/format";
import type { FrameSource } from "./pictures";

/** The frames of an experiment, once they are ready. */
export function frameSource({ id, stack, experiment }: Experiment): FrameSource | null {
  if (stack.state !== "ready" || !stack.n_frames || !stack.rows || !stack.columns) return null;
  return {
    experimentId: id,
    n_frames: stack.n_frames,
    rows: stack.rows,
    columns: stack.columns,
    pixel_size_um: Number(experiment.pixel_size_um),
    checksum: stack.checksum,
  };
}

/** Time of a frame since the first, where frames come at one interval. */
export function timeOfFrame(experiment: Experiment, frame: number): string | undefined {
  const interval_s = experiment.experiment.frame_interval_s;
  return typeof interval_s === "number" ? `t = ${formatDuration(frame * interval_s)}` : undefined;
}
