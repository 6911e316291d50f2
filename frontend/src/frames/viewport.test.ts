import { expect, it } from "vitest";
import {
  bounded,
  imagePoint,
  mappingOf,
  panned,
  viewFromText,
  viewToText,
  wholeFrame,
  zoomedAt,
} from "./viewport";

const place = { columns: 2000, rows: 1000, width: 800, height: 400 };

it("zooming keeps the point under the pointer where it is", () => {
  const before = zoomedAt(wholeFrame(place), place, 4, 300, 200);
  const after = zoomedAt(before, place, 1.7, 500, 120);
  const seen = imagePoint(mappingOf(before, place), 500, 120);
  const still = imagePoint(mappingOf(after, place), 500, 120);
  expect(still.x_px).toBeCloseTo(seen.x_px, 6);
  expect(still.y_px).toBeCloseTo(seen.y_px, 6);
});

it("nothing beyond the frame is ever seen", () => {
  const corner = bounded({ zoom: 2, x_px: -50, y_px: 5000 }, place);
  expect(corner).toEqual({ zoom: 2, x_px: 500, y_px: 750 });
  expect(panned(corner, place, 9999, -9999)).toEqual(corner);
  expect(zoomedAt(corner, place, 0.1, 10, 10)).toEqual(wholeFrame(place));
});

it("the centre of the top left pixel is (0, 0)", () => {
  const { x_px, y_px } = imagePoint(mappingOf(wholeFrame(place), place), 0.2, 0.2);
  expect([x_px, y_px]).toEqual([0, 0]);
});

it("a view survives its way through the address, and nonsense is passed over", () => {
  expect(viewFromText(viewToText({ zoom: 2.512, x_px: 100.4, y_px: 7 }))).toEqual({
    zoom: 2.51,
    x_px: 100,
    y_px: 7,
  });
  expect(viewToText(wholeFrame(place))).toBeUndefined();
  expect(["1,2", "a,b,c", "0,1,1", undefined].map(viewFromText)).toEqual([
    undefined,
    undefined,
    undefined,
    undefined,
  ]);
});
