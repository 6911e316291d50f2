import type { FrameDroplets } from "../client";
import type { Painter } from "../frames/FrameCanvas";
import type { Arrow, ArrowField } from "./arrows";
import type { Layer } from "./view";

/** Colours over grey frames: the paper's red and green; the flow in colours apart from both. */
export const LAYER_COLOURS: Record<Layer, string> = {
  now: "#ff5c5c",
  next: "#4ade80",
  flow: "#5cc8ff",
  interpolated: "#ffb84d",
};

export type OverlayData = { droplets: FrameDroplets | null; field: ArrowField | null };

/** Droplets of this frame and where they are in the next, and the flow that carries them. */
export function overlayPainter(
  { droplets, field }: OverlayData,
  isShown: (layer: Layer) => boolean,
): Painter {
  return (context, scale) => {
    if (droplets && isShown("next")) paintNext(context, scale, droplets);
    if (droplets && isShown("now")) paintNow(context, scale, droplets);
    if (!field) return;
    const { arrows } = field;
    if (isShown("interpolated")) paintArrows(context, scale, arrows.filter(isInterpolated), "interpolated");
    if (isShown("flow"))
      paintArrows(
        context,
        scale,
        arrows.filter((arrow) => !isInterpolated(arrow)),
        "flow",
      );
  };
}

function isInterpolated(arrow: Arrow): boolean {
  return arrow.isInterpolated;
}

/** The centre of the top left pixel is (0, 0): half a pixel lies above and left of it. */
function onScreen(value_px: number, scale: number): number {
  return (value_px + 0.5) * scale;
}

type Context = CanvasRenderingContext2D;

function paintNow(context: Context, scale: number, droplets: FrameDroplets): void {
  context.lineWidth = 1.4;
  context.strokeStyle = LAYER_COLOURS.now;
  for (const wasDetected of [true, false]) {
    // Droplets that detection missed and prediction found are dashed.
    context.setLineDash(wasDetected ? [] : [3, 2.5]);
    context.beginPath();
    droplets.x_px.forEach((x, index) => {
      if ((droplets.is_detected?.[index] ?? true) !== wasDetected) return;
      circle(context, scale, x, droplets.y_px[index] ?? 0, droplets.r_px[index] ?? 0);
    });
    context.stroke();
  }
  context.setLineDash([]);
}

function paintNext(context: Context, scale: number, droplets: FrameDroplets): void {
  context.lineWidth = 1.2;
  context.strokeStyle = LAYER_COLOURS.next;
  context.beginPath();
  droplets.next_x_px?.forEach((x, index) => {
    const [y, r] = [droplets.next_y_px?.[index], droplets.next_r_px?.[index]];
    if (x == null || y == null || r == null) return;
    circle(context, scale, x, y, r);
  });
  context.stroke();
}

function circle(context: Context, scale: number, x_px: number, y_px: number, r_px: number): void {
  const [x, y, r] = [onScreen(x_px, scale), onScreen(y_px, scale), Math.max(1, r_px * scale)];
  context.moveTo(x + r, y);
  context.arc(x, y, r, 0, 2 * Math.PI);
}

const HEAD_SHARE = 0.32;
const HEAD_MAX = 8;

function paintArrows(context: Context, scale: number, arrows: Arrow[], layer: Layer): void {
  // A dark edge keeps arrows readable on bright droplets; interpolated ones stand back.
  const isFaint = layer === "interpolated";
  context.globalAlpha = isFaint ? 0.75 : 1;
  for (const [colour, width] of [
    ["rgba(0, 0, 0, 0.5)", isFaint ? 2.4 : 3.4],
    [LAYER_COLOURS[layer], isFaint ? 1 : 1.7],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.lineCap = "round";
    context.lineJoin = "round";
    context.beginPath();
    for (const arrow of arrows) traceArrow(context, scale, arrow);
    context.stroke();
  }
  context.globalAlpha = 1;
}

function traceArrow(context: Context, scale: number, { x_px, y_px, dx_px, dy_px }: Arrow): void {
  const [x, y, dx, dy] = [onScreen(x_px, scale), onScreen(y_px, scale), dx_px * scale, dy_px * scale];
  const length = Math.hypot(dx, dy);
  if (length < 0.5) return;
  const head = Math.min(HEAD_MAX, length * HEAD_SHARE) / length;
  const [tipX, tipY] = [x + dx, y + dy];
  context.moveTo(x, y);
  context.lineTo(tipX, tipY);
  for (const side of [1, -1]) {
    context.moveTo(tipX, tipY);
    context.lineTo(tipX - head * (dx + side * 0.6 * dy), tipY - head * (dy - side * 0.6 * dx));
  }
}
