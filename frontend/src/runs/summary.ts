import type { Run } from "../client";
import { formatCount, formatNumber } from "../platform/format";
import { labelAndUnit } from "../platform/units";

export type Summary = NonNullable<Run["summary"]>;

/** A number of `summary.json` by its dotted path. */
export function numberAt(summary: Run["summary"] | undefined, path: string): number | null {
  const found = path
    .split(".")
    .reduce<unknown>((value, name) => (value as Record<string, unknown> | null | undefined)?.[name], summary);
  return typeof found === "number" ? found : null;
}

/** How many droplets were detected, all frames together. */
export function nDroplets(summary: Run["summary"] | undefined): number | null {
  return numberAt(summary, "detected.n_droplets");
}

export type KeyNumber = { name: string; value: string; unit?: string; about?: string };

/** The numbers that people look for first; those that a run does not have are left out. */
export function keyNumbers(summary: Run["summary"]): KeyNumber[] {
  const at = (path: string) => numberAt(summary, path);
  const [rms_u, rms_v] = [at("flow.rms_u_um_s"), at("flow.rms_v_um_s")];
  const numbers: (KeyNumber | null)[] = [
    counted("Droplets detected", at("detected.n_droplets"), at("detected.n_droplets_per_frame"), "a frame"),
    counted("Trajectories", at("n_trajectories"), at("mean_trajectory_frames"), "frames long on average"),
    measured("Mean radius, tracked", at("tracked.mean_radius_um"), "µm", spread(at("tracked.radius_std_um"))),
    measured("Sauter radius, tracked", at("tracked.sauter_radius_um"), "µm", "volume over surface"),
    rms_u === null || rms_v === null
      ? null
      : measured(
          "Flow, rms",
          Math.hypot(rms_u, rms_v),
          "µm/s",
          `${formatNumber(rms_u)} along x, ${formatNumber(rms_v)} along y`,
        ),
    measured(
      "Found by prediction",
      percent(at("tracked.found_by_prediction_share")),
      "%",
      "of tracked droplets",
    ),
  ];
  return numbers.filter((number) => number !== null);
}

function counted(name: string, count: number | null, average: number | null, what: string): KeyNumber | null {
  if (count === null) return null;
  return {
    name,
    value: formatCount(count),
    about: average === null ? undefined : `${formatNumber(average)} ${what}`,
  };
}

function measured(name: string, value: number | null, unit: string, about?: string): KeyNumber | null {
  return value === null ? null : { name, value: formatNumber(value), unit, about };
}

function spread(std: number | null): string | undefined {
  return std === null ? undefined : `standard deviation ${formatNumber(std)} µm`;
}

function percent(share: number | null): number | null {
  return share === null ? null : 100 * share;
}

/** A value of the summary with its unit; shares (0 to 1) in percent. */
export function shownNumber(name: string, value: unknown): string {
  const { unit } = labelAndUnit(name);
  const scaled = typeof value === "number" && name.endsWith("_share") ? 100 * value : value;
  const text = Array.isArray(scaled)
    ? scaled.map((part) => formatNumber(Number(part), 4)).join(" × ")
    : typeof scaled === "number"
      ? formatNumber(scaled, 4)
      : String(scaled ?? "–");
  const shown = name.endsWith("_share") ? "%" : unit;
  return shown ? `${text} ${shown}` : text;
}
