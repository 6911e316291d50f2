import { expect, it } from "vitest";
import { rangeFromText, rangeToText } from "./ranges";
import { runSearch } from "./view";

it("the address holds tab, frame, ranges and hidden layers", () => {
  const search = { tab: "flow", frame: 12, t: "1..5", r: "4..40", hide: ["next"] };
  expect(runSearch(search)).toEqual(search);
});

it("what an address says wrongly is passed over", () => {
  expect(runSearch({ tab: "nonsense", frame: -1, t: "a..b", r: 5, hide: ["what"] })).toEqual({});
});

it("a range survives its way through the address", () => {
  expect(rangeFromText(rangeToText([0.123456, 1234567]))).toEqual([0.12346, 1234600]);
  expect([rangeFromText("3..3"), rangeFromText("1..2..3"), rangeFromText(undefined)]).toEqual([
    undefined,
    undefined,
    undefined,
  ]);
});
