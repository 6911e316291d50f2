import { expect, it } from "vitest";
import { SvgPen } from "./pen";
import { paintStamp, scaleBar } from "./stamp";

it("the bar has a round length and at most a quarter of the width", () => {
  expect(scaleBar(1000, 0.625)).toEqual({ length_um: 100, width: 160, text: "100 µm" });
  expect(scaleBar(800, 10)?.text).toBe("2 mm");
  expect(scaleBar(0, 1)).toBeNull();
});

it("bar and time are drawn", () => {
  const pen = new SvgPen();
  paintStamp(pen, { width: 800, height: 600, um_per_screen_px: 1, text: "t = 12 s" });
  expect(pen.elements.filter((element) => element.startsWith("<text"))).toHaveLength(2);
  expect(pen.elements.join()).toContain("t = 12 s");
});
