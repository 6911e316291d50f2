import { expect, it } from "vitest";
import { isPlain, levelsOf, PLAIN, retone } from "./tone";

it("the plain tone changes nothing", () => {
  expect(isPlain(PLAIN)).toBe(true);
  expect([...levelsOf(PLAIN)]).toEqual(Array.from({ length: 256 }, (_, level) => level));
});

it("levels outside the window are black and white, and gamma lifts the dark ones", () => {
  const levels = levelsOf({ black: 0.2, white: 0.8, gamma: 2 });
  expect([levels[0], levels[51], levels[204], levels[255]]).toEqual([0, 0, 255, 255]);
  expect(levels[128]).toBeGreaterThan(170);
  expect(levelsOf({ black: 0.5, white: 0.5, gamma: 1 })[200]).toBe(255);
});

it("only colours change, not opacity", () => {
  const pixels = Uint8ClampedArray.from([51, 51, 51, 255, 204, 204, 204, 128]);
  retone(pixels, { black: 0.2, white: 0.8, gamma: 1 });
  expect([...pixels]).toEqual([0, 0, 0, 255, 255, 255, 255, 128]);
});
