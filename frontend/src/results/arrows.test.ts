import { expect, it } from "vitest";
import type { FrameFlow } from "../client";
import { arrowsOf, roundUp } from "./arrows";

const FLOW: FrameFlow = {
  frame: 0,
  grid_x_px: [50, 150],
  grid_y_px: [40, 120],
  u_um_s: [
    [3, null],
    [0, -3],
  ],
  v_um_s: [
    [4, null],
    [5, 4],
  ],
  droplet_count: [
    [2, 0],
    [1, 3],
  ],
  is_interpolated: [
    [false, false],
    [true, false],
  ],
};

it("arrows start at the centres of their cells and point along the flow; cells without one have none", () => {
  const field = arrowsOf(FLOW);
  expect(field?.key_um_s).toBe(5);
  expect(field?.key_px).toBeCloseTo(140);
  expect(field?.arrows).toHaveLength(3);
  expect(field?.arrows[0]).toMatchObject({ x_px: 50, y_px: 40, isInterpolated: false });
  expect(field?.arrows[0]?.dx_px).toBeCloseTo(84);
  expect(field?.arrows[0]?.dy_px).toBeCloseTo(112);
  expect(field?.arrows[1]).toMatchObject({ x_px: 50, y_px: 120, isInterpolated: true });
});

it("a frame without flow has no arrows", () => {
  expect(arrowsOf({ ...FLOW, u_um_s: [[null, null]], v_um_s: [[null, null]] })).toBeNull();
  expect(arrowsOf({ ...FLOW, u_um_s: [[0, 0]], v_um_s: [[0, 0]] })).toBeNull();
});

it.each([
  [0.9, 1],
  [1, 1],
  [1.2, 2],
  [21, 50],
  [0.03, 0.05],
])("the round number from %s on is %s", (value, round) => {
  expect(roundUp(value)).toBe(round);
});
