import { expect, it } from "vitest";
import { type Figure, marksFrom, momentAt } from "./figure";
import { fitted } from "./fitting";

const packed = (values: number[]) => ({
  dtype: "f8",
  bdata: btoa(String.fromCharCode(...new Uint8Array(new Float64Array(values).buffer))),
});
const OSCILLATIONS: Figure = {
  data: [
    { name: "signal", x: [0, 1] },
    { name: "peak", x: packed([1, 2.5]) },
    { name: "uncertain peak", x: [4] },
  ],
  layout: { xaxis: { title: { text: "time t (min)" } } },
};
const SIZES: Figure = { data: [], layout: { xaxis: { title: { text: "time t (h)" } }, yaxis: {} } };
const LOOK = { isDark: false, height: 400, width: 900 };

it("peaks are moments in seconds, whatever the axis counts in and however numbers are written", () => {
  expect(marksFrom(OSCILLATIONS)).toEqual([
    { time_s: 60, kind: "certain" },
    { time_s: 150, kind: "certain" },
    { time_s: 240, kind: "uncertain" },
  ]);
});

it("a mark stands across every figure over time, in its own unit, and on no other figure", () => {
  const marks = [{ time_s: 1800, kind: "certain" }] as const;
  expect(fitted(SIZES, { ...LOOK, marks }).layout.shapes).toMatchObject([
    { x0: 0.5, x1: 0.5, yref: "paper" },
  ]);
  const radii = { data: [], layout: { xaxis: { title: { text: "radius r (µm)" } } } };
  expect(fitted(radii, { ...LOOK, marks }).layout.shapes).toEqual([]);
});

it("plots under each other have one time axis at one place; a zoom goes before it", () => {
  const aligned = fitted(SIZES, { ...LOOK, aligned_s: [0, 7200] }).layout;
  expect(aligned.xaxis).toMatchObject({ range: [0, 2], automargin: false });
  const zoomed = fitted(SIZES, { ...LOOK, aligned_s: [0, 7200], ranges: { time_s: [3600, 5400] } }).layout;
  expect(zoomed.xaxis).toMatchObject({ range: [1, 1.5] });
  expect(zoomed.margin).toEqual(aligned.margin);
});

it("a click is a moment where time lies below, and nothing elsewhere", () => {
  expect(momentAt([{ x: 0.5 }], SIZES.layout)).toBe(1800);
  expect(momentAt([{ x: 0.5 }], { xaxis: { title: { text: "radius r (µm)" } } })).toBeNull();
});
