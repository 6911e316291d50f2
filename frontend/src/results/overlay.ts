import type { FrameDroplets, Tails } from "../client";
import type { Painter, Pen } from "../frames/pen";
import type { Arrow, ArrowField } from "./arrows";
import { colourSteps, type Scale, stepOf } from "./colours";
import type { Colouring, Layer } from "./view";

/** Colours over grey frames: the paper's red and green; the flow in colours apart from both. */
export const LAYER_COLOURS: Record<Layer, string> = {
  now: "#ff5c5c",
  predicted: "#ff5c5c",
  next: "#4ade80",
  steps: "#ffffff",
  tails: "#f9e076",
  flow: "#5cc8ff",
  interpolated: "#ffb84d",
  rejected: "#c9a3ff",
};

/** Candidates that were no droplets, and why. */
export type RejectedCandidates = { x_px: number[]; y_px: number[]; r_px: number[]; reason: string[] };

export type OverlayData = {
  droplets: FrameDroplets | null;
  field: ArrowField | null;
  tails?: Tails | null;
  rejected?: RejectedCandidates | null;
  /** Number of the trajectory that stands out. */
  chosen?: number;
  colouring?: { by: Colouring; scale: Scale };
  /** Where droplets were expected in the next frame. */
  predictions?: { predicted_x_px: (number | null)[]; predicted_y_px: (number | null)[] };
  /** Arrows stand over a coloured map, where only dark ones are seen everywhere. */
  isOverMap?: boolean;
};

/** Everything over a frame: droplets now and next, where they come from, and the flow that carries them. */
export function overlayPainter(data: OverlayData, isShown: (layer: Layer) => boolean): Painter {
  const { droplets, field, tails, rejected } = data;
  return (pen, scale) => {
    if (rejected && isShown("rejected")) paintRejected(pen, scale, rejected);
    if (tails && isShown("tails")) paintTails(pen, scale, tails);
    if (droplets && isShown("next")) paintNext(pen, scale, droplets);
    if (droplets && isShown("steps")) paintSteps(pen, scale, droplets);
    if (data.predictions && isShown("steps")) paintPredictions(pen, scale, data.predictions);
    if (droplets && isShown("now")) paintNow(pen, scale, data, true);
    if (droplets && isShown("predicted")) paintNow(pen, scale, data, false);
    for (const layer of ["interpolated", "flow"] as const) {
      if (!field || !isShown(layer)) continue;
      const isWanted = ({ isInterpolated }: Arrow) => isInterpolated === (layer === "interpolated");
      paintArrows(pen, scale, field.arrows.filter(isWanted), layer, data.isOverMap);
    }
    if (droplets && data.chosen !== undefined) paintChosen(pen, scale, droplets, data.chosen);
  };
}

/** The centre of the top left pixel is (0, 0): half a pixel lies above and left of it. */
function onScreen(value_px: number, scale: number): number {
  return (value_px + 0.5) * scale;
}

function circle(pen: Pen, scale: number, x_px: number, y_px: number, r_px: number, more = 0): void {
  const [x, y, r] = [onScreen(x_px, scale), onScreen(y_px, scale), Math.max(1, r_px * scale + more)];
  pen.moveTo(x + r, y);
  pen.arc(x, y, r, 0, 2 * Math.PI);
}

/** Droplets of this frame: whole circles where detection saw them, dashed where prediction found them. */
function paintNow(pen: Pen, scale: number, data: OverlayData, wasDetected: boolean): void {
  const droplets = data.droplets as FrameDroplets;
  pen.lineWidth = 1.4;
  pen.setLineDash(wasDetected ? [] : [3, 2.5]);
  for (const [colour, indices] of byColour(droplets, wasDetected, data.colouring)) {
    pen.strokeStyle = colour;
    pen.beginPath();
    for (const index of indices) {
      circle(pen, scale, droplets.x_px[index] ?? 0, droplets.y_px[index] ?? 0, droplets.r_px[index] ?? 0);
    }
    pen.stroke();
  }
  pen.setLineDash([]);
}

function byColour(
  droplets: FrameDroplets,
  wasDetected: boolean,
  colouring: OverlayData["colouring"],
): Map<string, number[]> {
  const groups = new Map<string, number[]>();
  const values = colouring?.by === "match" ? droplets.match : droplets.r_px;
  droplets.x_px.forEach((_, index) => {
    if ((droplets.is_detected?.[index] ?? true) !== wasDetected) return;
    const step = colouring ? stepOf(values[index] ?? 0, colouring.scale) : 0;
    const colour = colouring ? (colourSteps()[step] as string) : LAYER_COLOURS.now;
    const group = groups.get(colour);
    if (group) group.push(index);
    else groups.set(colour, [index]);
  });
  return groups;
}

function forEachStep(
  droplets: FrameDroplets,
  draw: (index: number, x: number, y: number, r: number) => void,
): void {
  droplets.next_x_px?.forEach((x, index) => {
    const [y, r] = [droplets.next_y_px?.[index], droplets.next_r_px?.[index]];
    if (x != null && y != null && r != null) draw(index, x, y, r);
  });
}

function paintNext(pen: Pen, scale: number, droplets: FrameDroplets): void {
  pen.lineWidth = 1.2;
  pen.strokeStyle = LAYER_COLOURS.next;
  pen.beginPath();
  forEachStep(droplets, (_, x, y, r) => circle(pen, scale, x, y, r));
  pen.stroke();
}

/** From where a droplet is to where it is in the next frame. */
function paintSteps(pen: Pen, scale: number, droplets: FrameDroplets): void {
  pen.lineWidth = 1.2;
  pen.strokeStyle = LAYER_COLOURS.steps;
  pen.beginPath();
  forEachStep(droplets, (index, x, y) => {
    pen.moveTo(onScreen(droplets.x_px[index] ?? 0, scale), onScreen(droplets.y_px[index] ?? 0, scale));
    pen.lineTo(onScreen(x, scale), onScreen(y, scale));
  });
  pen.stroke();
}

const CROSS_PX = 4;

function paintPredictions(pen: Pen, scale: number, at: NonNullable<OverlayData["predictions"]>): void {
  pen.lineWidth = 1.4;
  pen.strokeStyle = LAYER_COLOURS.tails;
  pen.beginPath();
  for (const [index, x_px] of at.predicted_x_px.entries()) {
    const y_px = at.predicted_y_px[index];
    if (x_px === null || y_px == null) continue;
    const [x, y] = [onScreen(x_px, scale), onScreen(y_px, scale)];
    pen.moveTo(x - CROSS_PX, y);
    pen.lineTo(x + CROSS_PX, y);
    pen.moveTo(x, y - CROSS_PX);
    pen.lineTo(x, y + CROSS_PX);
  }
  pen.stroke();
}

function paintTails(pen: Pen, scale: number, { offsets, x_px, y_px }: Tails): void {
  pen.lineWidth = 1.5;
  pen.lineJoin = "round";
  pen.globalAlpha = 0.85;
  pen.strokeStyle = LAYER_COLOURS.tails;
  pen.beginPath();
  offsets.slice(0, -1).forEach((start, tail) => {
    const end = offsets[tail + 1] ?? start;
    for (let at = start; at < end; at++) {
      const [x, y] = [onScreen(x_px[at] ?? 0, scale), onScreen(y_px[at] ?? 0, scale)];
      if (at === start) pen.moveTo(x, y);
      else pen.lineTo(x, y);
    }
  });
  pen.stroke();
  pen.globalAlpha = 1;
}

function paintRejected(pen: Pen, scale: number, { x_px, y_px, r_px }: RejectedCandidates): void {
  pen.lineWidth = 1.1;
  pen.setLineDash([1.5, 2.5]);
  pen.strokeStyle = LAYER_COLOURS.rejected;
  pen.beginPath();
  for (const [index, x] of x_px.entries()) circle(pen, scale, x, y_px[index] ?? 0, r_px[index] ?? 0);
  pen.stroke();
  pen.setLineDash([]);
}

function paintChosen(pen: Pen, scale: number, droplets: FrameDroplets, chosen: number): void {
  const index = droplets.trajectory_id?.indexOf(chosen) ?? -1;
  if (index < 0) return;
  const [x, y, r] = [droplets.x_px[index] ?? 0, droplets.y_px[index] ?? 0, droplets.r_px[index] ?? 0];
  for (const [colour, width] of [
    ["#000", 5],
    ["#fff", 2.5],
  ] as const) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    circle(pen, scale, x, y, r, 4);
    pen.stroke();
  }
}

const HEAD_SHARE = 0.32;
const HEAD_MAX = 8;

function paintArrows(pen: Pen, scale: number, arrows: Arrow[], layer: Layer, isOverMap = false): void {
  // An edge keeps arrows readable on bright droplets and on every colour of a map; interpolated ones stand back.
  const isFaint = layer === "interpolated";
  pen.globalAlpha = isFaint ? 0.75 : 1;
  for (const [colour, width] of [
    [isOverMap ? "rgba(255, 255, 255, 0.55)" : "rgba(0, 0, 0, 0.5)", isFaint ? 2.4 : 3.4],
    [isOverMap ? "#111417" : LAYER_COLOURS[layer], isFaint ? 1 : 1.7],
  ] as const) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.lineCap = "round";
    pen.lineJoin = "round";
    pen.beginPath();
    for (const arrow of arrows) traceArrow(pen, scale, arrow);
    pen.stroke();
  }
  pen.globalAlpha = 1;
}

function traceArrow(pen: Pen, scale: number, { x_px, y_px, dx_px, dy_px }: Arrow): void {
  const [x, y, dx, dy] = [onScreen(x_px, scale), onScreen(y_px, scale), dx_px * scale, dy_px * scale];
  const length = Math.hypot(dx, dy);
  if (length < 0.5) return;
  const head = Math.min(HEAD_MAX, length * HEAD_SHARE) / length;
  const [tipX, tipY] = [x + dx, y + dy];
  pen.moveTo(x, y);
  pen.lineTo(tipX, tipY);
  for (const side of [1, -1]) {
    pen.moveTo(tipX, tipY);
    pen.lineTo(tipX - head * (dx + side * 0.6 * dy), tipY - head * (dy - side * 0.6 * dx));
  }
}

/** The droplet at a point: the smallest circle around it, else the nearest rim within reach. */
export function dropletAt(
  { x_px, y_px, r_px }: Pick<FrameDroplets, "x_px" | "y_px" | "r_px">,
  point: { x_px: number; y_px: number; reach_px: number },
): number | null {
  let best: { index: number; rank: number } | null = null;
  x_px.forEach((x, index) => {
    const r = r_px[index] ?? 0;
    const distance = Math.hypot(x - point.x_px, (y_px[index] ?? 0) - point.y_px);
    if (distance > r + point.reach_px) return;
    const rank = distance <= r ? r : 1e6 + distance - r;
    if (!best || rank < best.rank) best = { index, rank };
  });
  return (best as { index: number } | null)?.index ?? null;
}
