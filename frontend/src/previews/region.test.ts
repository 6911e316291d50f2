import { expect, it } from "vitest";
import type { Preview } from "../client";
import { firstRegion, patched } from "./region";

const LARGE = { rows: 2000, columns: 2400 };

it("a small frame is looked at whole, of a large one the middle first", () => {
  expect(firstRegion({ rows: 500, columns: 600 }, { zoom: 1, x_px: 300, y_px: 250 })).toBeNull();
  const region = firstRegion(LARGE, { zoom: 1, x_px: 1200, y_px: 1000 });
  expect((region?.width_px ?? 0) * (region?.height_px ?? 0)).toBeCloseTo(700_000, -4);
  expect((region?.x_px ?? 0) + (region?.width_px ?? 0) / 2 - 1200).toBeCloseTo(0, -1);
});

it("what is zoomed at is looked at first", () => {
  expect(firstRegion(LARGE, { zoom: 4, x_px: 300, y_px: 250 })).toEqual({
    x_px: 0,
    y_px: 0,
    width_px: 600,
    height_px: 500,
  });
});

const found = (x_px: number[], region: Preview["region"] = null) =>
  ({
    ...{ frame: 0, region, took_s: 0, probability: [] },
    ...{ x_px, y_px: x_px.map(() => 5), r_px: x_px.map(() => 3), match: x_px.map(() => 1) },
    rejected: { x_px: [], y_px: [], r_px: [], reason: [] },
  }) as Preview;

it("a new part takes the place of the old one, and what lies outside stays until it is looked at", () => {
  const part = found([12], { x_px: 10, y_px: 0, width_px: 10, height_px: 10 });
  expect(patched(part, found([3, 11, 19, 20])).x_px).toEqual([12, 3, 20]);
  expect(patched(part, undefined).x_px).toEqual([12]);
});
