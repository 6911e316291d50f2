import { expect, it } from "vitest";
import { stampOf } from "./source";

it("a frame says its own time, also where frames are missing, and its temperature", () => {
  const clock = { time_s: [10, 11, 14], temperature_c: [30, 30.114, 30.5] };
  expect(stampOf(clock, 2)).toBe("t = 4 s, T = 30.50 °C");
  expect(stampOf({ ...clock, temperature_c: null }, 1)).toBe("t = 1 s");
  expect(stampOf(clock, 3)).toBeUndefined();
});
