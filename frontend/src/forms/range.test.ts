import { expect, it } from "vitest";
import { rangeInWords } from "./FieldLabel";

it.each([
  [{}, ""],
  [{ minimum: 0, maximum: 1 }, "Range: 0 to 1"],
  [{ exclusiveMinimum: 0 }, "Range: more than 0"],
  [{ minimum: 2 }, "Range: at least 2"],
  [{ exclusiveMinimum: 0, maximum: 1 }, "Range: more than 0, at most 1"],
  [{ exclusiveMaximum: 5 }, "Range: less than 5"],
])("bounds are said as people say them: %o", (range, words) => {
  expect(rangeInWords(range)).toBe(words);
});
