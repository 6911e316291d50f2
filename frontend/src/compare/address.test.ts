import { expect, it } from "vitest";
import { compareSearch } from "./address";

it("an address names at most eight runs, each once", () => {
  const many = Array.from({ length: 12 }, (_, index) => `run-${index % 10}`);
  expect(compareSearch({ runs: many }).runs).toEqual(many.slice(0, 8));
  expect(compareSearch({ runs: ["a", "a", 3] }).runs).toEqual(["a"]);
  expect(compareSearch({ runs: "a" }).runs).toBeUndefined();
});

it("ranges that are none are left out", () => {
  expect(compareSearch({ t: "1..5", r: "x" })).toEqual({ runs: undefined, t: "1..5", r: undefined });
});
