import { expect, it } from "vitest";
import { rangeFromText, rangeToText } from "./ranges";
import { runSearch } from "./view";

it("the address holds the whole view", () => {
  const search = {
    ...{ tab: "frames", frame: 12, t: "1..5", r: "4..40", at: 3.5, layers: ["next"], colour: "match" },
    ...{ view: "2,10,20", droplet: 7, map: "vorticity", mean: true, figure: "growth" },
  };
  expect(runSearch(search)).toEqual(search);
});

it("no layer at all is something else than the usual ones", () => {
  expect(runSearch({ layers: [] }).layers).toEqual([]);
  expect(runSearch({}).layers).toBeUndefined();
});

it("what an address says wrongly is passed over", () => {
  const wrong = {
    tab: "nonsense",
    frame: -1,
    t: "a..b",
    r: 5,
    layers: "what",
    view: "1",
    droplet: 1.5,
    at: "x",
  };
  expect(runSearch(wrong)).toEqual({});
});

it("a range survives its way through the address", () => {
  expect(rangeToText([5, 19.87654321])).toBe("5..19.877");
  expect(rangeToText([0.123456, 1234567])).toBe("0..1234600");
  expect([rangeFromText("3..3"), rangeFromText("1..2..3"), rangeFromText(undefined)]).toEqual([
    undefined,
    undefined,
    undefined,
  ]);
});

it.each([
  [40012.345678, 40013.2],
  [-3.2e-5, 7.7e-5],
  [0.1 + 0.2, 0.6],
  [1.5e9, 1.50000001e9],
])("what was inside from %d to %d is inside again, and hardly more", (low, high) => {
  const [first, last] = rangeFromText(rangeToText([low, high])) as [number, number];
  expect(first - low).toBeLessThanOrEqual(1e-9 * (high - low));
  expect(high - last).toBeLessThanOrEqual(1e-9 * (high - low));
  expect(Math.max(low - first, last - high)).toBeLessThanOrEqual(1e-4 * (high - low));
});
