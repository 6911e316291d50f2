/** A figure made to fit the page: its colours, its size, its ranges. All pure. */
import {
  type Figure,
  isAxis,
  isCaption,
  isLog,
  type Json,
  type Layout,
  type Mark,
  type Range,
  type Ranges,
  sharedAxis,
  type Trace,
} from "./figure";

export type Look = {
  isDark: boolean;
  height: number;
  width: number;
  ranges?: Ranges;
  /** Where all plots of a page stand under each other: one time axis, as long as the film, at the same place. */
  aligned_s?: Range;
  marks?: readonly Mark[];
};

const INK = { light: "#1f2328", dark: "#d5dade" };
const LINE = { light: "#8b949e", dark: "#6b747c" };

/** A figure in the page's colours and size. Its title and caption stand around it as text. */
export function fitted({ data, layout }: Figure, look: Look): Figure {
  const { title: _, width: __, ...rest } = layout;
  const ink = look.isDark ? INK.dark : INK.light;
  const isNarrow = look.width < 720;
  const fittedLayout: Layout = {
    ...rest,
    autosize: true,
    height: look.height,
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: "Inter Variable, sans-serif", size: 12, color: ink },
    // As said, whatever stands on the axes: Plotly would draw everything again for each thing that is wider.
    margin: {
      l: LEFT_PX,
      r: rightPx(data, layout, look),
      t: look.aligned_s || isLegendAbove(layout) ? 30 : MARGIN_PX,
      b: 48,
      autoexpand: false,
    },
    shapes: [...((layout.shapes as Json[] | undefined) ?? []), ...marksOf(layout, look)],
    legend: {
      ...(layout.legend as Json),
      ...(look.aligned_s ? ABOVE : legendPlace(layout, isNarrow)),
      bgcolor: "rgba(0,0,0,0)",
      borderwidth: 0,
    },
    annotations: (layout.annotations ?? [])
      .filter((note) => !isCaption(note))
      .map((note) => inked(note, ink)),
    dragmode: "zoom",
    modebar: {
      bgcolor: "rgba(0,0,0,0)",
      color: look.isDark ? LINE.dark : LINE.light,
      activecolor: ink,
    },
  };
  for (const name of Object.keys(layout).filter(isAxis)) {
    fittedLayout[name] = fittedAxis(name, layout[name] as Json, look);
  }
  return { data: data.map((trace) => fittedTrace(trace, ink, look.isDark)), layout: fittedLayout };
}

function fittedAxis(name: string, axis: Json, look: Look): Json {
  const colour = look.isDark ? LINE.dark : LINE.light;
  const shared = sharedAxis(axis);
  const wanted =
    shared && (look.ranges?.[shared.kind] ?? (shared.kind === "time_s" ? look.aligned_s : undefined));
  const range = wanted && shared && wanted.map((value) => value / shared.factor);
  const ranged = range ? { range: isLog(axis) ? range.map(Math.log10) : range, autorange: false } : {};
  const title = name.startsWith("y") ? fittingTitle(axis, look.height) : axis.title;
  return { ...axis, title, linecolor: colour, tickcolor: colour, automargin: false, ...ranged };
}

/** A title longer than its axis is high, in two lines. Those of the axes below each other are short. */
function fittingTitle(axis: Json, height: number): unknown {
  const text = (axis.title as Json | undefined)?.text;
  const [low, high] = (axis.domain as [number, number] | undefined) ?? [0, 1];
  const most = ((height - 64) * (high - low)) / LETTER_PX;
  if (typeof text !== "string" || text.includes("<br>") || text.replace(/<[^>]*>/g, "").length <= most)
    return axis.title;
  const middle = text.length / 2;
  const spaces = [...text.matchAll(/ /g)].map(({ index }) => index);
  const [at] = spaces.sort((a, b) => Math.abs(a - middle) - Math.abs(b - middle));
  const lines = at === undefined ? text : `${text.slice(0, at)}<br>${text.slice(at + 1)}`;
  return { ...(axis.title as Json), text: lines, font: { size: 11 } };
}

const ABOVE = { orientation: "h", x: 1, y: 1, xanchor: "right", yanchor: "bottom" };
const MARK_LINES = {
  certain: { color: "#D55E00", width: 1.2 },
  uncertain: { color: "#D55E00", width: 1.2, dash: "dot" },
  chosen: { color: "#0072B2", width: 2 },
};

/** A line across the plot for each mark, on the first axis of time that lies below it. */
function marksOf(layout: Layout, { marks = [], isDark }: Look): Json[] {
  const name = Object.keys(layout).find(
    (one) => /^xaxis\d*$/.test(one) && sharedAxis(layout[one] as Json)?.kind === "time_s",
  );
  const shared = name && sharedAxis(layout[name] as Json);
  if (!name || !shared) return [];
  return marks.map(({ time_s, kind }) => {
    const [at, line] = [time_s / shared.factor, MARK_LINES[kind]];
    const color = isDark ? (BRIGHTER[line.color.toLowerCase()] ?? line.color) : line.color;
    const xref = name.replace("axis", "");
    return { type: "line", x0: at, x1: at, y0: 0, y1: 1, xref, yref: "paper", line: { ...line, color } };
  });
}

function fittedTrace(trace: Trace, ink: string, isDark: boolean): Trace {
  const seen = isDark ? brightened(trace) : trace;
  if (!seen.colorbar) return seen;
  const colorbar = { ...seen.colorbar, outlinecolor: ink, tickcolor: ink, thickness: 14, len: 1 };
  return { ...seen, colorbar, hoverongaps: false };
}

/** The figures' colours that are too dark for a dark ground, and lighter ones of the same hue. */
const BRIGHTER: Record<string, string> = {
  "#0072b2": "#4aa8e0",
  "#009e73": "#21c295",
  "#d55e00": "#f0802b",
  "#000000": INK.dark,
};

function brightened(trace: Trace): Trace {
  const better = (part: unknown): unknown => {
    const colour = (part as Json | undefined)?.color;
    const lighter = typeof colour === "string" ? BRIGHTER[colour.toLowerCase()] : undefined;
    return lighter ? { ...(part as Json), color: lighter } : part;
  };
  const parts = ["line", "marker", "error_y"].filter((name) => name in trace);
  return { ...trace, ...Object.fromEntries(parts.map((name) => [name, better(trace[name])])) };
}

function inked(note: Json, ink: string): Json {
  return { ...note, font: { ...(note.font as Json), color: ink } };
}

export const MARGIN_PX = 16;
/** Room for the numbers and the title of an axis. */
const LEFT_PX = 78;
const RIGHT_AXIS_PX = 62;
/** How wide a letter of a title is, about. */
const LETTER_PX = 6.8;
/** Beside the axes, for a colour bar with its title. */
export const COLOUR_BAR_PX = 92;

function hasColourBar(data: Trace[]): boolean {
  return data.some(({ colorbar, showscale }) => colorbar && showscale !== false);
}

function isLegendAbove({ legend, showlegend }: Layout): boolean {
  const { orientation, y } = (legend ?? {}) as Json;
  return showlegend !== false && orientation === "h" && typeof y === "number" && y >= 1;
}

function rightPx(data: Trace[], layout: Layout, look: Look): number {
  if (Object.keys(layout).some((name) => isAxis(name) && (layout[name] as Json).side === "right"))
    return RIGHT_AXIS_PX;
  if (look.aligned_s) return MARGIN_PX;
  return look.width < 720 && !hasColourBar(data) ? MARGIN_PX : marginRight(data, layout);
}

/** Room beside the axes: for a colour bar, or what the figure itself asked for, for a legend there. */
function marginRight(data: Trace[], layout: Layout): number {
  if (hasColourBar(data)) return MARGIN_PX + COLOUR_BAR_PX;
  const margin = layout.margin as { r?: number } | undefined;
  return data.some(({ colorbar }) => colorbar) ? MARGIN_PX : Math.max(MARGIN_PX, margin?.r ?? MARGIN_PX);
}

function legendPlace(layout: Layout, isNarrow: boolean): Json {
  const isBeside = marginRight([], layout) > 100;
  return isBeside && isNarrow ? { orientation: "h", x: 0, y: -0.12, xanchor: "left", yanchor: "top" } : {};
}
