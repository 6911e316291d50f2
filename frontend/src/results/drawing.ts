/** A figure in its element: drawn anew where it changed, moved where only its ranges did, left alone where it shows them. */
import { type Figure, isAxis, type Layout, sharedAxis } from "./figure";
import { fitted, type Look } from "./fitting";
import { inPixels } from "./pixels";

type Json = Record<string, unknown>;
/** What of Plotly is used here. */
export type Drawer = {
  react: (element: HTMLElement, data: never, layout: never, config: never) => Promise<unknown>;
  relayout: (element: HTMLElement, update: never) => Promise<unknown>;
};
export type Drawing = {
  show: (figure: Figure, look: Look, config: object) => void;
  /** Whether a zoom that Plotly tells of was made by hand, and not here. */
  isByHand: () => boolean;
  /** The layout with the ranges that are shown now. */
  layout: () => Layout;
  /** Ranges that Plotly itself shows since a zoom by hand. */
  zoomed: (event: Json) => void;
};

/** Ends closer than this share of the range are the same on any screen. */
const SAME_SHARE = 1e-3;

export function drawingIn(element: HTMLElement, plotly: Drawer): Drawing {
  let layout: Layout = {};
  let drawn: readonly unknown[] = [];
  let nOwn = 0;
  const move = async (moved: Json) => {
    nOwn += 1;
    try {
      await plotly.relayout(element, moved as never);
    } finally {
      nOwn -= 1;
    }
  };
  return {
    show(figure, look, config) {
      const next = fitted(inPixels(figure), look);
      const { ranges: _, ...still } = look;
      const parts = [figure, ...Object.entries(still).flat()];
      const isSame = parts.length === drawn.length && parts.every((part, index) => part === drawn[index]);
      const moved = isSame ? movedAxes(layout, next.layout) : null;
      drawn = parts;
      if (moved && Object.keys(moved).length === 0) return;
      layout = next.layout;
      if (moved) void move(moved);
      else {
        const sized = { ...layout, width: look.width };
        void plotly.react(element, next.data as never, sized as never, config as never);
      }
    },
    isByHand: () => nOwn === 0,
    layout: () => layout,
    zoomed(event) {
      layout = { ...layout };
      for (const name of Object.keys(layout).filter(isAxis)) {
        const axis = layout[name] as Json;
        // Other axes are the reader's own: nothing moves them back before there are new data.
        if (!sharedAxis(axis)) continue;
        const ends = [event[`${name}.range[0]`], event[`${name}.range[1]`]];
        const range = event[`${name}.range`] ?? (ends.every((end) => end !== undefined) ? ends : undefined);
        if (range) layout[name] = { ...axis, range, autorange: false };
        else if (event[`${name}.autorange`] === true) layout[name] = { ...axis, autorange: true };
      }
    },
  };
}

/** What `relayout` is told so that the axes show what they should; nothing where they do. */
function movedAxes(shown: Layout, wanted: Layout): Json {
  const moved: Json = {};
  for (const name of Object.keys(wanted).filter(isAxis)) {
    const [now, next] = [shown[name] as Json | undefined, wanted[name] as Json];
    const [from, to] = [rangeOf(now), rangeOf(next)];
    if (to && !(from && isClose(from, to))) moved[`${name}.range`] = to;
    else if (!to && from) moved[`${name}.autorange`] = true;
  }
  return moved;
}

function rangeOf(axis: Json | undefined): [number, number] | null {
  const range = axis?.range;
  const isRange =
    axis?.autorange !== true && Array.isArray(range) && range.every((end) => typeof end === "number");
  return isRange ? (range as [number, number]) : null;
}

function isClose(a: [number, number], b: [number, number]): boolean {
  const span = Math.abs(b[1] - b[0]) * SAME_SHARE;
  return Math.abs(a[0] - b[0]) <= span && Math.abs(a[1] - b[1]) <= span;
}
