import { formatNumber } from "../platform/format";
import type { Pen } from "./pen";

/** A bar of a round length and what it says, at most a quarter of the width. */
export type ScaleBar = { length_um: number; width: number; text: string };

const STEPS = [1, 2, 5];
const SHARE_MAX = 0.25;

export function scaleBar(width: number, um_per_screen_px: number): ScaleBar | null {
  const longest_um = width * SHARE_MAX * um_per_screen_px;
  if (!(longest_um > 0) || !Number.isFinite(longest_um)) return null;
  const decade = 10 ** Math.floor(Math.log10(longest_um));
  const step = STEPS.filter((one) => one * decade <= longest_um * (1 + 1e-9)).at(-1) ?? 1;
  const length_um = Number((step * decade).toPrecision(6));
  const text = length_um >= 1000 ? `${formatNumber(length_um / 1000)} mm` : `${formatNumber(length_um)} µm`;
  return { length_um, width: length_um / um_per_screen_px, text };
}

export type Stamp = { width: number; height: number; um_per_screen_px: number; text?: string; size?: number };

/** Scale bar at the bottom right, time (and temperature) at the bottom left, readable on any ground. */
export function paintStamp(pen: Pen, { width, height, um_per_screen_px, text, size = 13 }: Stamp): void {
  const [margin, line] = [size, size * 1.7];
  pen.globalAlpha = 1;
  pen.setLineDash([]);
  pen.font = `600 ${size}px "Inter Variable", Inter, Helvetica, Arial, sans-serif`;
  const bar = scaleBar(width, um_per_screen_px);
  if (bar) {
    const [right, bottom] = [width - margin, height - margin];
    const wide = Math.max(bar.width, size * 4);
    ground(pen, right - wide - size * 0.6, bottom - line - size * 0.4, wide + size * 1.2, line + size * 0.9);
    pen.fillStyle = "#fff";
    pen.fillRect(right - bar.width, bottom - size * 0.35, bar.width, size * 0.35);
    pen.textAlign = "right";
    pen.fillText(bar.text, right, bottom - size * 0.75);
  }
  if (text) {
    const wide = text.length * size * 0.6 + size;
    ground(pen, margin - size * 0.5, height - margin - line * 0.9, wide, line * 1.05);
    pen.fillStyle = "#fff";
    pen.textAlign = "start";
    pen.fillText(text, margin, height - margin - size * 0.35);
  }
}

function ground(pen: Pen, x: number, y: number, width: number, height: number): void {
  pen.fillStyle = "rgba(10, 12, 14, 0.62)";
  pen.fillRect(x, y, width, height);
}
