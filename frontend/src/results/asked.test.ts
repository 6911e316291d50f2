import { expect, it } from "vitest";
import type { FigureEntry } from "../client";
import { askedOf, askedQuery } from "./asked";

const parameters = [{ name: "from_s" }, { name: "to_s" }, { name: "frame" }] as FigureEntry["parameters"];

it("a figure is asked only what it takes", () => {
  expect(askedOf({ parameters }, { time_s: [1, 5], radius_um: [4, 9] })).toEqual({ from_s: 1, to_s: 5 });
  expect(askedOf({ parameters }, {})).toEqual({});
});

it("what is not asked has no place in the address", () => {
  expect(askedQuery({ frame: 0, from_s: null })).toEqual({ frame: 0, from_s: undefined });
});
