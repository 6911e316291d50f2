import { expect, it } from "vitest";
import type { FlowMap } from "../client";
import { SvgPen } from "../frames/pen";
import { colourAt, edgesOf, mapPainter, mapScale, quantityOf } from "./maps";

it("signed quantities have their white at zero and the same reach to both sides", () => {
  expect(mapScale([[-3, 1, null]], "vorticity")).toEqual({ low: -1, high: 1, isSigned: true });
  expect(mapScale([[0.2, 17, 19]], "speed")).toMatchObject({ low: 0, high: 20 });
  expect(colourAt(0.5, true)).toBe("rgb(246 246 246)");
  expect([colourAt(-1, false), colourAt(2, false)]).toEqual(["rgb(68 1 84)", "rgb(253 231 37)"]);
});

it("cells touch each other and begin at the corner of the frame", () => {
  expect(edgesOf([9.5, 29.5, 49.5])).toEqual([0, 20, 40, 60]);
});

it("a cell without a value is not painted", () => {
  const map = { grid_x_px: [9.5, 29.5], grid_y_px: [9.5], speed_um_s: [[1, null]] } as unknown as FlowMap;
  const pen = new SvgPen();
  mapPainter(map, "speed", { low: 0, high: 2, isSigned: false })(pen, 1);
  expect(pen.elements).toHaveLength(1);
  expect(pen.elements[0]).toContain('x="0"');
});

it("only quantities that are known are taken from the address", () => {
  expect([quantityOf("speed"), quantityOf("toString"), quantityOf(undefined)]).toEqual([
    "speed",
    undefined,
    undefined,
  ]);
});
