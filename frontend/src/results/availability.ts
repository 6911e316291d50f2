import type { FigureName, Run, StageName } from "../client";
import { isActive } from "../runs/states";

/** How much of what a stage makes there is: nothing to ask for, some that grows, or all that there will be. */
export type Availability = "none" | "growing" | "whole";

/** Detection shows what is done part by part; what later stages make appears when they are through. */
export function availability(run: Pick<Run, "state" | "stages">, name: StageName): Availability {
  const stage = run.stages.find((one) => one.name === name);
  if (!stage) return "none";
  if (stage.state === "completed") return "whole";
  if (name !== "detect" || stage.done_frames === 0) return "none";
  return isActive(run.state) ? "growing" : "whole";
}

const EARLY: Partial<Record<FigureName, StageName[]>> = {
  size_distribution_before: ["detect", "analyse"],
  size_distribution_after: ["track", "analyse"],
  size_distribution_at: ["detect", "track", "analyse"],
  moments: ["detect", "track", "analyse"],
  flow_field: ["track"],
  displacement: ["track"],
  forward_tracking: ["track"],
  backward_tracking: ["track"],
  flow_moments: ["track"],
};

/** The stages whose results a figure shows; the first one decides when there is anything. */
export function stagesOf(name: FigureName): StageName[] {
  return EARLY[name] ?? ["analyse"];
}
