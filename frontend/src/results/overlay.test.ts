import { expect, it } from "vitest";
import type { FrameDroplets } from "../client";
import { SvgPen } from "../frames/pen";
import { scaleOf, stepOf } from "./colours";
import { dropletAt, LAYER_COLOURS, overlayPainter } from "./overlay";

const droplets = {
  ...{ frame: 3, x_px: [10, 12, 100], y_px: [10, 10, 100], r_px: [20, 4, 5], match: [0.1, 0.5, 0.9] },
  ...{ trajectory_id: [7, 8, 9], is_detected: [true, true, false] },
  ...{ next_x_px: [11, null, 103], next_y_px: [9, null, 99], next_r_px: [20, null, 5] },
} as FrameDroplets;

function colours(paint: ReturnType<typeof overlayPainter>): string[] {
  const pen = new SvgPen();
  paint(pen, 2);
  return pen.elements.map((element) => /stroke="([^"]+)"/.exec(element)?.[1] ?? "");
}

it("only what is switched on is drawn", () => {
  const data = { droplets, field: null };
  expect(colours(overlayPainter(data, (layer) => layer === "next"))).toEqual([LAYER_COLOURS.next]);
  expect(colours(overlayPainter(data, () => false))).toEqual([]);
});

it("circles are coloured by match, each group once", () => {
  const data = { droplets, field: null, colouring: { by: "match" as const, scale: scaleOf(droplets.match) } };
  expect(new Set(colours(overlayPainter(data, (layer) => layer === "now"))).size).toBe(2);
});

it("a click finds the smallest droplet around it, else the nearest rim in reach", () => {
  expect(dropletAt(droplets, { x_px: 12, y_px: 11, reach_px: 2 })).toBe(1);
  expect(dropletAt(droplets, { x_px: 25, y_px: 10, reach_px: 2 })).toBe(0);
  expect(dropletAt(droplets, { x_px: 107, y_px: 100, reach_px: 3 })).toBe(2);
  expect(dropletAt(droplets, { x_px: 300, y_px: 300, reach_px: 3 })).toBeNull();
});

it("one odd value does not take all colours", () => {
  const values = [...Array.from({ length: 200 }, (_, index) => index), 1e6];
  const scale = scaleOf(values);
  expect(scale.high).toBeLessThan(250);
  expect([stepOf(-5, scale), stepOf(1e6, scale)]).toEqual([0, 8]);
});
