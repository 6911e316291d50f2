/** The figures of the API, and what they say: what their axes show, their moments, ranges, captions. All pure. */
import { numbers } from "./numbers";

export type Json = Record<string, unknown>;
export type Trace = Json & {
  type?: string;
  zmin?: number;
  zmax?: number;
  colorbar?: Json;
  showscale?: boolean;
};
export type Layout = Json & { annotations?: Json[] };
export type Figure = { data: Trace[]; layout: Layout };

export type Range = [number, number];
/** Ranges that all figures share, whichever of their axes shows them. */
export type Ranges = { time_s?: Range; radius_um?: Range };
/** What a zoom by hand changed; `null` where it was taken back. */
export type RangeChange = { time_s?: Range | null; radius_um?: Range | null };

/** A moment that stands out on every axis of time. */
export type Mark = { time_s: number; kind: "certain" | "uncertain" | "chosen" };

/** What an axis shows, where it is one of the shared ranges, and how much of its unit (s or um) is one on it. */
export function sharedAxis(axis: Json | undefined): { kind: keyof Ranges; factor: number } | null {
  const title = (axis?.title as Json | undefined)?.text;
  if (typeof title !== "string") return null;
  const time = /^time t \((s|min|h)\)/.exec(title);
  if (time) return { kind: "time_s", factor: { s: 1, min: 60, h: 3600 }[time[1] as "s" | "min" | "h"] };
  return /\bradius r\b/.test(title) ? { kind: "radius_um", factor: 1 } : null;
}

export function isAxis(name: string): boolean {
  return /^[xy]axis\d*$/.test(name);
}

/** Whether the ends of an axis are exponents: those of Plotly's own kind, and those that show log r on a linear one. */
export function isLog(axis: Json): boolean {
  return axis.type === "log" || axis.isLogarithm === true;
}

/** The peaks that the figure of oscillations shows, as marks for others. */
export function marksFrom({ data, layout }: Figure): Mark[] {
  const factor = sharedAxis(layout.xaxis as Json | undefined)?.factor ?? 1;
  return data.flatMap(({ name, x }) =>
    name === "peak" || name === "uncertain peak"
      ? numbers(x).map(
          (at) => ({ time_s: at * factor, kind: name === "peak" ? "certain" : "uncertain" }) as const,
        )
      : [],
  );
}

/** A moment in seconds at a click, where the figure has an axis of time below it. */
export function momentAt(points: readonly Json[], layout: Layout): number | null {
  const shared = sharedAxis(layout.xaxis as Json | undefined);
  const x = points[0]?.x;
  return shared?.kind === "time_s" && typeof x === "number" ? x * shared.factor : null;
}

/** The line below the axes that says where a figure comes from. */
export function isCaption(note: Json): boolean {
  return note.yref === "paper" && note.y === 0 && typeof note.yshift === "number" && note.yshift < 0;
}

export function captionOf({ layout }: Figure): string {
  const text = (layout.annotations ?? []).find(isCaption)?.text;
  return typeof text === "string" ? text.replace(/<br>/g, " ") : "";
}

/** The same colours for the same values in both: the widest scale of the two, one colour bar. */
export function withCommonColours(left: Figure | null, right: Figure | null): [Figure | null, Figure | null] {
  const scaled = [left, right].flatMap(
    (figure) => figure?.data.filter(({ zmin }) => zmin !== undefined) ?? [],
  );
  if (!left || !right || scaled.length < 2) return [left, right];
  const zmin = Math.min(...scaled.map((trace) => trace.zmin as number));
  const zmax = Math.max(...scaled.map((trace) => trace.zmax as number));
  const widest = scaled.reduce((best, trace) => (span(trace) > span(best) ? trace : best));
  const recolour = (figure: Figure, showscale: boolean): Figure => ({
    ...figure,
    data: figure.data.map((trace) =>
      trace.zmin === undefined ? trace : { ...trace, zmin, zmax, showscale, colorbar: widest.colorbar },
    ),
  });
  return [recolour(left, false), recolour(right, true)];
}

function span(trace: Trace): number {
  return (trace.zmax ?? 0) - (trace.zmin ?? 0);
}

/** What a zoom by hand says of the shared ranges. Log axes speak in exponents. */
export function rangesFromRelayout(event: Json, layout: Layout): RangeChange {
  const changed: RangeChange = {};
  for (const name of Object.keys(layout).filter(isAxis)) {
    const axis = layout[name] as Json;
    const shared = sharedAxis(axis);
    if (!shared) continue;
    const ends = (event[`${name}.range`] as unknown[] | undefined) ?? [
      event[`${name}.range[0]`],
      event[`${name}.range[1]`],
    ];
    if (ends.every((end) => typeof end === "number")) {
      const range = (ends as number[]).map((end) => (isLog(axis) ? 10 ** end : end) * shared.factor);
      changed[shared.kind] = range as Range;
    } else if (event[`${name}.autorange`] === true) changed[shared.kind] = null;
  }
  return changed;
}
