import { expect, it } from "vitest";
import type { Difference, Reuse } from "../client";
import { reuseLines } from "./reuse";

const STAGE = { name: "track" as const, total_frames: 400, reused_frames: 0 };

function lineOf(reused_frames: number, ...differences: Difference[]): string {
  const reuse: Reuse = { compared_with: 3, stages: [{ ...STAGE, reused_frames, differences }] };
  return reuseLines(reuse)[0]?.text ?? "";
}

const difference = (
  cause: Difference["cause"],
  field: string | null,
  before: unknown,
  now: unknown,
): Difference => ({
  cause,
  field,
  before,
  now,
});

it("what was taken over is said, and of the rest why not", () => {
  expect(lineOf(400)).toBe("taken over whole.");
  expect(lineOf(0, difference("parameter", "flow.n_rows", 20, 24))).toBe(
    "done anew: Flow, rows is 24, was 20 in run 3.",
  );
  expect(lineOf(120, difference("not_there", null, null, null))).toBe(
    "120 of 400 frames taken over: run 3 did not come to it.",
  );
});

it("other code, other frames and unset values are told in words", () => {
  expect(lineOf(0, difference("code", null, "0.1.0", "0.2.0"))).toBe(
    "done anew: made with version 0.2.0, run 3 with 0.1.0.",
  );
  expect(lineOf(0, difference("code", null, "0.1.0", "0.1.0"))).toBe(
    "done anew: the program has changed since.",
  );
  expect(lineOf(0, difference("frames", null, "a", "b"))).toBe(
    "done anew: the frames are not those of run 3.",
  );
  expect(lineOf(0, difference("experiment", "observation_depth_um", null, 200))).toContain(
    "was not set in run 3",
  );
});

it("of many differences the first few are shown", () => {
  const many = [1, 2, 3, 4, 5, 6].map((n) => difference("parameter", `flow.a${n}`, 0, n));
  expect(lineOf(0, ...many)).toContain(", and 2 more.");
});
