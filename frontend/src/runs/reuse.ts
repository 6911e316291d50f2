import type { Difference, Reuse } from "../client";
import { plainField } from "../platform/fields";
import { formatCount } from "../platform/format";
import { shown } from "./differing";
import { STAGE_TITLES } from "./states";

export type ReuseLine = { stage: string; text: string };

const MOST_SHOWN = 4;

/** All of it in a line. */
export function reuseSummary({ stages, compared_with }: Reuse): string {
  const taken = stages.filter(({ reused_frames, total_frames }) => reused_frames >= total_frames);
  if (taken.length === 0) return `Nothing was taken over from run ${compared_with}.`;
  const names = taken.map(({ name }) => (STAGE_TITLES[name] ?? name).toLowerCase());
  return `Taken over from earlier runs: ${names.join(", ")}.`;
}

/** One line a stage: `taken over whole`, or why it was done anew compared with the run before. */
export function reuseLines(reuse: Reuse): ReuseLine[] {
  return reuse.stages.map(({ name, total_frames, reused_frames, differences }) => {
    const stage = STAGE_TITLES[name] ?? name;
    if (reused_frames >= total_frames) return { stage, text: "taken over whole." };
    const part =
      reused_frames > 0
        ? `${formatCount(reused_frames)} of ${formatCount(total_frames)} frames taken over`
        : "done anew";
    const causes = differences.slice(0, MOST_SHOWN).map((found) => causeOf(found, reuse.compared_with));
    const more = differences.length > MOST_SHOWN ? `, and ${differences.length - MOST_SHOWN} more` : "";
    return { stage, text: causes.length > 0 ? `${part}: ${causes.join("; ")}${more}.` : `${part}.` };
  });
}

function causeOf({ cause, field, before, now }: Difference, run: number | null): string {
  switch (cause) {
    case "parameter":
    case "experiment":
      return `${plainField(field ?? "")} is ${inWords(field, now)}, was ${inWords(field, before)} in run ${run}`;
    case "frames":
      return `the frames are not those of run ${run}`;
    case "code":
      return before === now
        ? "the program has changed since"
        : `made with version ${now}, run ${run} with ${before}`;
    default:
      return `run ${run} did not come to it`;
  }
}

function inWords(field: string | null | undefined, value: unknown): string {
  return value === null || value === undefined ? "not set" : shown(field ?? "", value);
}
