import type { Preview, Region } from "../client";
import type { View } from "../frames/viewport";

/** A frame with more pixels than this is looked at in part first. */
const QUICK_PX = 700_000;

type Size = { rows: number; columns: number };

/** The part that is looked at first: what is seen, or the middle of a large frame; null where all is quick. */
export function firstRegion({ rows, columns }: Size, view: View): Region | null {
  if (rows * columns <= QUICK_PX) return null;
  const seen = (columns / view.zoom) * (rows / view.zoom);
  const shrink = Math.min(1, Math.sqrt(QUICK_PX / seen));
  const [width, height] = [(columns / view.zoom) * shrink, (rows / view.zoom) * shrink];
  return {
    x_px: Math.round(Math.max(0, view.x_px - width / 2)),
    y_px: Math.round(Math.max(0, view.y_px - height / 2)),
    width_px: Math.round(width),
    height_px: Math.round(height),
  };
}

type Found = Pick<Preview, "x_px" | "y_px" | "r_px" | "match" | "rejected">;

/** The part as it is now, and around it the frame as it was before the last change. */
export function patched(part: Preview, before: Preview | undefined): Found {
  const { region } = part;
  if (!region || !before) return part;
  const isOutside = (x: number, y: number) =>
    x < region.x_px ||
    x >= region.x_px + region.width_px ||
    y < region.y_px ||
    y >= region.y_px + region.height_px;
  const kept = indices(before.x_px, (x, index) => isOutside(x, before.y_px[index] ?? 0));
  const keptRejected = indices(before.rejected.x_px, (x, index) =>
    isOutside(x, before.rejected.y_px[index] ?? 0),
  );
  const pick = <Value>(values: Value[], which: number[]) => which.map((index) => values[index] as Value);
  return {
    x_px: [...part.x_px, ...pick(before.x_px, kept)],
    y_px: [...part.y_px, ...pick(before.y_px, kept)],
    r_px: [...part.r_px, ...pick(before.r_px, kept)],
    match: [...part.match, ...pick(before.match, kept)],
    rejected: {
      x_px: [...part.rejected.x_px, ...pick(before.rejected.x_px, keptRejected)],
      y_px: [...part.rejected.y_px, ...pick(before.rejected.y_px, keptRejected)],
      r_px: [...part.rejected.r_px, ...pick(before.rejected.r_px, keptRejected)],
      reason: [...part.rejected.reason, ...pick(before.rejected.reason, keptRejected)],
    },
  };
}

function indices(values: number[], isKept: (value: number, index: number) => boolean): number[] {
  return values.flatMap((value, index) => (isKept(value, index) ? [index] : []));
}
