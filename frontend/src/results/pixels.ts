/**
 * Heat maps over a logarithmic axis as Plotly draws them soonest. Over linear axes with cells of one size Plotly writes
 * one pixel a cell and lets the browser stretch them; else it paints rectangle by rectangle, ten times slower. The bins
 * of radius are of one size in log r: so the axis becomes one of log r, labelled with r.
 */
import type { Figure, Json, Layout, Trace } from "./figure";
import { numbers, rows } from "./numbers";

/** Cells whose sizes differ by less than this share are of one size. */
const SAME_SHARE = 0.005;
/** A film with long pauses is left to Plotly rather than drawn as so many empty columns. */
const MAX_COLUMNS = 3000;

const kept = new WeakMap<Figure, Figure>();

/** The same figure, its heat maps in pixels where they can be; computed once a figure. */
export function inPixels(figure: Figure): Figure {
  const known = kept.get(figure);
  if (known) return known;
  const made = pixelled(figure);
  kept.set(figure, made);
  return made;
}

function pixelled(figure: Figure): Figure {
  const axis = figure.layout.yaxis as Json | undefined;
  if (axis?.type !== "log" || figure.data.length === 0) return figure;
  const data = figure.data.map(evenTrace);
  return data.every((trace) => trace !== null) ? { data, layout: linear(figure.layout, axis) } : figure;
}

function linear(layout: Layout, axis: Json): Layout {
  const ticks = numbers(axis.tickvals);
  const yaxis = { ...axis, type: "linear", isLogarithm: true, tickvals: ticks.map(Math.log10) };
  return { ...layout, yaxis: { ...yaxis, ticktext: ticks.map(String) } };
}

function evenTrace(trace: Trace): Trace | null {
  const [x, y, z] = [numbers(trace.x), numbers(trace.y), rows(trace.z)];
  const heights = y.map(Math.log10);
  if (trace.type !== "heatmap" || x.length < 2 || z.length !== y.length - 1 || !isEven(heights)) return null;
  const steps = x.slice(1).map((edge, index) => edge - (x[index] as number));
  const step = [...steps].sort((a, b) => a - b)[Math.floor(steps.length / 2)] as number;
  const [start, end] = [x[0] as number, x[x.length - 1] as number];
  const n = Math.max(1, Math.ceil((end - start) / step - SAME_SHARE));
  if (!(n <= MAX_COLUMNS)) return null;
  const sources = columnsOf(x, start, step, n);
  const text = z.map((_, row) =>
    new Array(n).fill(Math.sqrt((y[row] as number) * (y[row + 1] as number)).toPrecision(3)),
  );
  return {
    ...trace,
    x: Array.from({ length: n + 1 }, (_, index) => start + index * step),
    y: heights,
    z: z.map((row) => sources.map((source) => row[source] as number)),
    text,
    hovertemplate: String(trace.hovertemplate ?? "").replace(/%\{y[^}]*\}/, "%{text}"),
  };
}

/** Which column of the edges `x` each of `n` even columns lies in, by its middle. */
function columnsOf(x: readonly number[], start: number, step: number, n: number): number[] {
  let source = 0;
  return Array.from({ length: n }, (_, index) => {
    const middle = start + (index + 0.5) * step;
    while (source < x.length - 2 && (x[source + 1] as number) <= middle) source += 1;
    return source;
  });
}

function isEven(edges: readonly number[]): boolean {
  const mean = ((edges[edges.length - 1] as number) - (edges[0] as number)) / (edges.length - 1);
  return edges.every(
    (edge, index) => index === 0 || Math.abs(edge - (edges[index - 1] as number) - mean) < SAME_SHARE * mean,
  );
}
