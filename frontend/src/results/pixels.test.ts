import { expect, it } from "vitest";
import { type Figure, type Json, rangesFromRelayout } from "./figure";
import { fitted } from "./fitting";
import { inPixels } from "./pixels";

const map = (x: number[], z: (number | null)[][]): Figure => ({
  data: [{ type: "heatmap", x, y: [1, 10, 100], z, hovertemplate: "t %{x:.4g} s<br>r %{y:.3g} µm" }],
  layout: {
    xaxis: { title: { text: "time t (s)" } },
    yaxis: { title: { text: "radius r (µm)" }, type: "log", range: [0, 2], tickvals: [1, 10, 100] },
  },
});
const first = (figure: Figure) => figure.data[0] as Json;

it("a map over log r becomes one of even cells, with the same values at the same places", () => {
  const drawn = inPixels(map([0, 2, 4, 5], [[1, 2, 3], [4, 5, 6]])); // biome-ignore format: as a matrix
  expect(first(drawn)).toMatchObject({ x: [0, 2, 4, 6], y: [0, 1, 2], z: [[1, 2, 3], [4, 5, 6]] }); // biome-ignore format: as a matrix
  expect(drawn.layout.yaxis).toMatchObject({
    type: "linear",
    range: [0, 2],
    tickvals: [0, 1, 2],
    ticktext: ["1", "10", "100"],
  });
  expect(first(drawn)).toMatchObject({ hovertemplate: "t %{x:.4g} s<br>r %{text} µm" });
  expect((first(drawn).text as string[][]).map((row) => row[0])).toEqual(["3.16", "31.6"]);
});

it("what is missing in time stays as wide as it is", () => {
  const drawn = inPixels(map([0, 1, 2, 5, 6], [[1, 2, null, 3], [4, 5, null, 6]])); // biome-ignore format: as a matrix
  expect((first(drawn).z as number[][])[0]).toEqual([1, 2, Number.NaN, Number.NaN, Number.NaN, 3]);
});

it("packed numbers are the same numbers", () => {
  const packed = (values: number[], shape?: string) => ({
    ...{ dtype: "f4", shape },
    bdata: btoa(String.fromCharCode(...new Uint8Array(new Float32Array(values).buffer))),
  });
  const figure = map([0, 1, 2], [[1, 2], [3, 4]]); // biome-ignore format: as a matrix
  const sent = { ...first(figure), z: packed([1, 2, 3, 4], "2, 2"), x: packed([0, 1, 2]) };
  expect(first(inPixels({ ...figure, data: [sent as Figure["data"][0]] })).z).toEqual(
    first(inPixels(figure)).z,
  );
});

it("ranges are micrometres in and out, as over a log axis", () => {
  const drawn = fitted(inPixels(map([0, 1, 2], [[1, 2], [3, 4]])), { isDark: false, height: 400, width: 600, ranges: { radius_um: [10, 100] } }); // biome-ignore format: as a matrix
  expect(drawn.layout.yaxis).toMatchObject({ range: [1, 2], autorange: false });
  expect(rangesFromRelayout({ "yaxis.range": [0, 1] }, drawn.layout)).toEqual({ radius_um: [1, 10] });
});

it("what is no such map, and a film with very long pauses, is left as it is", () => {
  const line: Figure = { data: [{ type: "scatter", x: [1], y: [1] }], layout: { yaxis: { type: "log" } } };
  expect(inPixels(line)).toBe(line);
  const paused = map([0, 1, 1e6, 1e6 + 1, 1e6 + 2], [[1, 2, 3, 4], [1, 2, 3, 4]]); // biome-ignore format: as a matrix
  expect(inPixels(paused)).toBe(paused);
});
