import { queryOptions, useQuery } from "@tanstack/react-query";
import { useCallback } from "react";
import { type Clock, clockGet, type Experiment } from "../client";
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

/** Time and temperature of every frame; asked for once. */
function clockQuery({ id, stack, experiment }: Experiment) {
  const about = [stack.checksum, experiment.frame_interval_s, experiment.temperature_log];
  return queryOptions({
    queryKey: ["experiments", id, "clock", ...about],
    queryFn: async ({ signal }) => (await clockGet({ path: { experiment_id: id }, signal })).data,
    enabled: stack.state === "ready",
    staleTime: Number.POSITIVE_INFINITY,
    retry: false,
  });
}

/** What stands in a corner of a frame: when it was taken, and how warm it was. */
export function useStamp(experiment: Experiment): (frame: number) => string | undefined {
  const { data } = useQuery(clockQuery(experiment));
  const interval_s = experiment.experiment.frame_interval_s;
  return useCallback(
    (frame: number) => (data ? stampOf(data, frame) : timeOfFrame(interval_s, frame)),
    [data, interval_s],
  );
}

export function stampOf({ time_s, temperature_c }: Clock, frame: number): string | undefined {
  const [time, temperature] = [time_s[frame], temperature_c?.[frame]];
  if (time === undefined) return undefined;
  const warm = temperature === undefined ? "" : `, T = ${temperature.toFixed(2)} °C`;
  return `t = ${formatDuration(time - (time_s[0] ?? 0))}${warm}`;
}

/** Until the clock is there, and where it is not: frames that come at one interval, none missing. */
function timeOfFrame(interval_s: unknown, frame: number): string | undefined {
  return typeof interval_s === "number" ? `t = ${formatDuration(frame * interval_s)}` : undefined;
}
