import { describe, expect, it } from "vitest";
import { captionOf, type Figure, rangesFromRelayout, withCommonColours } from "./figure";
import { fitted } from "./fitting";

const LOOK = { isDark: false, height: 400, width: 900 };

const HEAT: Figure = {
  data: [{ type: "heatmap", zmin: -8, zmax: -4, colorbar: { tickvals: [-8, -6, -4] } }],
  layout: {
    title: { text: "T" },
    width: 760,
    height: 520,
    xaxis: { title: { text: "time t (s)" } },
    yaxis: { type: "log", range: [0.6, 1.6], autorange: false, title: { text: "radius r (µm)" } },
    annotations: [
      { text: "experiment: a<br>run: 1", xref: "paper", yref: "paper", x: 0, y: 0, yshift: -50 },
      { text: "no droplets", xref: "paper", yref: "paper", x: 0.5, y: 0.5 },
    ],
  },
};

describe("fitted", () => {
  it("leaves title, width and caption to the page, and keeps what else is written on a figure", () => {
    const { layout } = fitted(HEAT, LOOK);
    expect(layout).not.toHaveProperty("title");
    expect(layout).not.toHaveProperty("width");
    expect(layout.annotations).toMatchObject([{ text: "no droplets" }]);
    expect(captionOf(HEAT)).toBe("experiment: a run: 1");
  });

  it("sets ranges as the axes count them: a log axis in exponents", () => {
    const { layout } = fitted(HEAT, { ...LOOK, ranges: { time_s: [1, 5], radius_um: [10, 100] } });
    expect(layout.xaxis).toMatchObject({ range: [1, 5], autorange: false });
    expect(layout.yaxis).toMatchObject({ range: [1, 2], autorange: false });
  });

  it("leaves the range that the figure chose where the page says none", () => {
    expect(fitted(HEAT, LOOK).layout.yaxis).toMatchObject({ range: [0.6, 1.6] });
  });
});

describe("rangesFromRelayout", () => {
  it("reads a zoom back in the units of the axes", () => {
    const event = { "xaxis.range[0]": 2, "xaxis.range[1]": 8, "yaxis.range[0]": 0, "yaxis.range[1]": 2 };
    expect(rangesFromRelayout(event, HEAT.layout)).toEqual({ time_s: [2, 8], radius_um: [1, 100] });
    expect(rangesFromRelayout({ "xaxis.range": [1, 3] }, HEAT.layout)).toEqual({ time_s: [1, 3] });
  });

  it("a shared range is in seconds and micrometres, whatever the axes count in, and wherever they stand", () => {
    const turned = {
      xaxis: { title: { text: "radius r (µm)" } },
      yaxis2: { title: { text: "time t (min)" } },
    };
    expect(rangesFromRelayout({ "xaxis.range": [4, 9], "yaxis2.range": [1, 2] }, turned)).toEqual({
      time_s: [60, 120],
      radius_um: [4, 9],
    });
    const { layout } = fitted({ data: [], layout: turned }, { ...LOOK, ranges: { time_s: [60, 120] } });
    expect(layout.yaxis2).toMatchObject({ range: [1, 2] });
    expect(rangesFromRelayout({ "yaxis.range": [1, 2] }, { yaxis: { title: { text: "fraction" } } })).toEqual(
      {},
    );
  });

  it("tells a zoom that was taken back from one that did not happen", () => {
    expect(rangesFromRelayout({ "xaxis.autorange": true }, HEAT.layout)).toEqual({ time_s: null });
    expect(rangesFromRelayout({ width: 500 }, HEAT.layout)).toEqual({});
  });
});

describe("withCommonColours", () => {
  const other: Figure = {
    data: [{ type: "heatmap", zmin: -6, zmax: -3, colorbar: { tickvals: [-6] } }],
    layout: {},
  };

  it("gives both figures the scale that holds all values, and one colour bar", () => {
    const [left, right] = withCommonColours(HEAT, other);
    expect(left?.data[0]).toMatchObject({ zmin: -8, zmax: -3, showscale: false });
    expect(right?.data[0]).toMatchObject({
      zmin: -8,
      zmax: -3,
      showscale: true,
      colorbar: { tickvals: [-8, -6, -4] },
    });
  });

  it("leaves a figure alone that has no partner yet", () => {
    expect(withCommonColours(HEAT, null)).toEqual([HEAT, null]);
  });
});

it("a title longer than its axis is high stands in two lines; a legend above and an axis at the right have room", () => {
  const long = "droplets per area and radius (µm<sup>−3</sup>), depth unknown";
  const layout = { yaxis: { title: { text: long } }, xaxis: { title: { text: long } } };
  const low = fitted({ data: [], layout }, { isDark: false, height: 300, width: 900 }).layout;
  expect((low.yaxis as { title: { text: string } }).title.text.split("<br>")).toHaveLength(2);
  expect((low.xaxis as { title: { text: string } }).title.text).toBe(long);
  const high = fitted({ data: [], layout }, { isDark: false, height: 500, width: 900 }).layout;
  expect((high.yaxis as { title: { text: string } }).title.text).toBe(long);
  const two = { legend: { orientation: "h", y: 1 }, yaxis2: { side: "right" } };
  expect(
    fitted({ data: [], layout: two }, { isDark: false, height: 240, width: 500 }).layout.margin,
  ).toMatchObject({
    t: 30,
    r: 62,
  });
});
