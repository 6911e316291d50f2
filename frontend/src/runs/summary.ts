import type { Run } from "../client";

export type Summary = NonNullable<Run["summary"]>;

/** How many droplets were detected, all frames together. */
export function nDroplets(summary: Run["summary"] | undefined): number | null {
  const count = summary?.n_droplets;
  return typeof count === "number" ? count : null;
}

export type KeyNumber = { name: string; value: string; unit?: string; about?: string };

export function keyNumbers(_summary: Run["summary"]): KeyNumber[] {
  return [];
}
