import { expect, it } from "vitest";
import { keyAction } from "./keys";
import { neighbours, sideFor } from "./pictures";

function press(key: string, target = "DIV", shiftKey = false) {
  return keyAction({ key, shiftKey, target: document.createElement(target) }, 20, 99);
}

it("arrows step, with Shift ten at a time; Home and End go to the ends; the space bar plays", () => {
  expect(press("ArrowRight")).toEqual({ frame: 21 });
  expect(press("ArrowLeft", "DIV", true)).toEqual({ frame: 10 });
  expect([press("Home"), press("End"), press(" "), press("x")]).toEqual([
    { frame: 0 },
    { frame: 99 },
    "play",
    null,
  ]);
});

it("plus and minus zoom, zero shows the whole frame", () => {
  expect([press("+"), press("="), press("-"), press("0")]).toEqual(["closer", "closer", "wider", "whole"]);
});

it("keys that an input or a button uses itself are left to it", () => {
  expect([press("ArrowLeft", "INPUT"), press(" ", "BUTTON")]).toEqual([null, null]);
});

it("the frames fetched ahead lie in the stack, those to come first", () => {
  expect(neighbours(5, 100)).toEqual([6, 7, 8, 4]);
  expect(neighbours(0, 2)).toEqual([1]);
  expect(neighbours(9, 10)).toEqual([8]);
});

it("pictures come in few sizes, none much smaller than its place", () => {
  expect([300, 640, 1000, 5000].map(sideFor)).toEqual([600, 600, 1200, 8192]);
});
