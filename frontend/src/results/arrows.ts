import type { FrameFlow } from "../client";

/** An arrow in image pixels, its tail at the centre of its cell. */
export type Arrow = { x_px: number; y_px: number; dx_px: number; dy_px: number; isInterpolated: boolean };

export type ArrowField = {
  arrows: Arrow[];
  /** Speed and length of the arrow in the key. */
  key_um_s: number;
  key_px: number;
};

const FAST_SHARE = 0.95;
const FAST_CELLS = 1.4;

type Field = Pick<FrameFlow, "grid_x_px" | "grid_y_px" | "u_um_s" | "v_um_s" | "is_interpolated">;

/** Arrows of a flow field. A fast one is somewhat longer than a cell; lengths grow with speed. */
export function arrowsOf(flow: Field): ArrowField | null {
  const speeds = flow.u_um_s.flatMap((row, j) => row.flatMap((u, i) => speedOf(u, flow.v_um_s[j]?.[i])));
  const fast = speeds.sort((a, b) => a - b)[Math.floor(FAST_SHARE * (speeds.length - 1))];
  if (!fast) return null;
  // The key's speed is a round number, and the scale follows from it: so neighbouring frames share their scale.
  const key_um_s = roundUp(fast);
  const key_px = FAST_CELLS * cellSize(flow);
  const px_per_um_s = key_px / key_um_s;
  const arrows = flow.grid_y_px.flatMap((y_px, j) =>
    flow.grid_x_px.flatMap((x_px, i) => {
      const [u, v] = [flow.u_um_s[j]?.[i], flow.v_um_s[j]?.[i]];
      if (u == null || v == null) return [];
      const isInterpolated = flow.is_interpolated[j]?.[i] ?? false;
      return [{ x_px, y_px, dx_px: u * px_per_um_s, dy_px: v * px_per_um_s, isInterpolated }];
    }),
  );
  return { arrows, key_um_s, key_px };
}

function speedOf(u: number | null | undefined, v: number | null | undefined): number[] {
  return u == null || v == null ? [] : [Math.hypot(u, v)];
}

function cellSize({ grid_x_px }: Field): number {
  const [first, second] = grid_x_px;
  return first !== undefined && second !== undefined ? second - first : 50;
}

/** The next of 1, 2, 5, 10, ... */
export function roundUp(value: number): number {
  const decade = 10 ** Math.floor(Math.log10(value));
  const step = [1, 2, 5, 10].find((one) => one * decade >= value * (1 - 1e-9)) ?? 10;
  return Number((step * decade).toPrecision(6));
}
