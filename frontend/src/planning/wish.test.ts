import { expect, it } from "vitest";
import { PAPER, planSearch, wishOf } from "./wish";

it("without a word the ramp is the paper's", () => {
  expect(wishOf(planSearch({}))).toEqual({
    start_c: PAPER.start_c,
    end_c: PAPER.end_c,
    driving_per_s: PAPER.xi,
  });
});

it("a duration takes the place of the driving parameter", () => {
  expect(wishOf(planSearch({ hours: 2, xi: 1e-5, protocol: true }))).toEqual({
    start_c: PAPER.start_c,
    end_c: PAPER.end_c,
    duration_s: 7200,
    has_protocol: true,
  });
});

it("what an address says wrongly is passed over", () => {
  expect(planSearch({ xi: "fast", material: 3, protocol: "yes", other: 1 })).toEqual({});
});
