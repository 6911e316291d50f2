import { expect, it } from "vitest";
import type { Stage } from "../client";
import { colourOfRun } from "./colour";
import { differing } from "./differing";
import { detailsOf, percentOf } from "./StageProgress";
import { doneShare } from "./states";
import { keyNumbers, shownNumber } from "./summary";

const STAGE: Stage = {
  name: "detect",
  state: "running",
  done_frames: 120,
  total_frames: 400,
  reused_frames: 0,
  frames_per_s: 2.14,
  seconds_left: 130.8,
  seconds_left_std: 6.2,
};

it("of several runs only the parameters that differ are shown, with their units", () => {
  const runs = [
    { detection: { radius_min_um: 4, radius_max_um: 40 }, flow: { n_rows: 20 } },
    { detection: { radius_min_um: 3, radius_max_um: 40 }, flow: { n_rows: 20 } },
  ];
  expect(differing(runs).map((one) => one.map(({ label, value }) => `${label} = ${value}`))).toEqual([
    ["Detection, radius min = 4 µm"],
    ["Detection, radius min = 3 µm"],
  ]);
});

it("runs that are alike differ in nothing", () => {
  expect(differing([{ a: [1, 2] }, { a: [1, 2] }])).toEqual([[], []]);
});

it("a running stage says how far it is, how fast it goes and how long it takes still", () => {
  expect(detailsOf(STAGE)).toBe("120 of 400 frames, 2.1 frames/s, about 2 min 11 s left, ± 12 s");
  expect(detailsOf({ ...STAGE, reused_frames: 100, frames_per_s: null, seconds_left: null })).toBe(
    "120 of 400 frames (100 from an earlier run)",
  );
  expect(percentOf(STAGE)).toBe(30);
});

it("a completed stage is whole, however its frames were counted", () => {
  expect(percentOf({ ...STAGE, state: "completed", done_frames: 0 })).toBe(100);
  expect(
    doneShare([
      { ...STAGE, state: "completed" },
      { ...STAGE, state: "waiting", done_frames: 0 },
    ]),
  ).toBe(0.5);
  expect(doneShare([])).toBe(0);
});

it("a run has the same colour wherever it is shown, and its neighbours another", () => {
  expect(colourOfRun(3)).toBe(colourOfRun(3));
  expect(new Set([1, 2, 3, 4, 5, 6, 7, 8].map(colourOfRun)).size).toBe(8);
});

it("the key numbers of a summary carry their units, and those that are missing are left out", () => {
  const summary = {
    detected: { n_droplets: 14610, n_droplets_per_frame: 36.5 },
    tracked: { found_by_prediction_share: 0.0654 },
    flow: { rms_u_um_s: 3, rms_v_um_s: 4 },
  };
  expect(keyNumbers(summary)).toEqual([
    { name: "Droplets detected", value: "14\u2009610", about: "36.5 a frame" },
    { name: "Flow, rms", value: "5", unit: "µm/s", about: "3 along x, 4 along y" },
    { name: "Found by prediction", value: "6.54", unit: "%", about: "of tracked droplets" },
  ]);
  expect(keyNumbers(null)).toEqual([]);
});

it("numbers of a summary are shown in the units their names say", () => {
  expect([
    shownNumber("computed_share", 0.299),
    shownNumber("field_of_view_um", [382.5, 320]),
    shownNumber("n_frames", 40),
  ]).toEqual(["29.9 %", "382.5 × 320 µm", "40"]);
});
