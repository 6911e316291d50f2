/** What part of a frame is seen: its centre in image pixels, and how much larger than the whole frame it is drawn. */
export type View = { zoom: number; x_px: number; y_px: number };

/** A frame and the place it is drawn in, in screen pixels of the page. */
export type Place = { columns: number; rows: number; width: number; height: number };

/** From image to screen: `screen = (image + 0.5) * scale + left`; the centre of the top left pixel is (0, 0). */
export type Mapping = { scale: number; left: number; top: number };

export const ZOOM_MAX = 40;
export const ZOOM_STEP = 1.5;

export function wholeFrame({ columns, rows }: Pick<Place, "columns" | "rows">): View {
  return { zoom: 1, x_px: columns / 2, y_px: rows / 2 };
}

export function mappingOf(view: View, place: Place): Mapping {
  const scale = (place.width / place.columns) * view.zoom;
  return { scale, left: place.width / 2 - view.x_px * scale, top: place.height / 2 - view.y_px * scale };
}

/** The same view with its zoom in bounds and nothing seen beyond the frame. */
export function bounded(
  { zoom, x_px, y_px }: View,
  { columns, rows }: Pick<Place, "columns" | "rows">,
): View {
  const kept = clamp(zoom, 1, ZOOM_MAX);
  const [halfX, halfY] = [columns / kept / 2, rows / kept / 2];
  return { zoom: kept, x_px: clamp(x_px, halfX, columns - halfX), y_px: clamp(y_px, halfY, rows - halfY) };
}

/** Zoom by a factor so that the point under (x, y) on the screen stays where it is. */
export function zoomedAt(view: View, place: Place, factor: number, x: number, y: number): View {
  const before = mappingOf(view, place);
  const zoom = clamp(view.zoom * factor, 1, ZOOM_MAX);
  const scale = (place.width / place.columns) * zoom;
  const [imageX, imageY] = [(x - before.left) / before.scale, (y - before.top) / before.scale];
  const centred = {
    zoom,
    x_px: imageX - (x - place.width / 2) / scale,
    y_px: imageY - (y - place.height / 2) / scale,
  };
  return bounded(centred, place);
}

/** Move what is seen along with the pointer. */
export function panned(view: View, place: Place, dx: number, dy: number): View {
  const { scale } = mappingOf(view, place);
  return bounded({ ...view, x_px: view.x_px - dx / scale, y_px: view.y_px - dy / scale }, place);
}

/** The place in the image, in pixels whose centres are whole numbers, under a point of the screen. */
export function imagePoint(
  { scale, left, top }: Mapping,
  x: number,
  y: number,
): { x_px: number; y_px: number } {
  return { x_px: (x - left) / scale - 0.5, y_px: (y - top) / scale - 0.5 };
}

/** A view in the address: `2.5,1200,800`; the whole frame is no word at all. */
export function viewToText({ zoom, x_px, y_px }: View): string | undefined {
  return zoom === 1 ? undefined : `${Number(zoom.toPrecision(3))},${Math.round(x_px)},${Math.round(y_px)}`;
}

export function viewFromText(text: string | undefined): View | undefined {
  const [zoom, x_px, y_px, ...more] = (text ?? "").split(",").map(Number);
  if (zoom === undefined || x_px === undefined || y_px === undefined || more.length > 0) return undefined;
  return [zoom, x_px, y_px].every(Number.isFinite) && zoom >= 1 ? { zoom, x_px, y_px } : undefined;
}

function clamp(value: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, value));
}
