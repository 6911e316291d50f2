import type { FlowMap, FrameFlow } from "../client";
import type { Painter, Pen } from "../frames/pen";
import { roundUp } from "./arrows";

/** What can be drawn below the arrows of the flow. */
export const QUANTITIES = {
  speed: { title: "Speed", field: "speed_um_s", unit: "µm/s", isSigned: false },
  rms: { title: "Rms speed", field: "rms_um_s", unit: "µm/s", isSigned: false },
  vorticity: { title: "Vorticity", field: "vorticity_per_s", unit: "1/s", isSigned: true },
  divergence: { title: "Divergence", field: "divergence_per_s", unit: "1/s", isSigned: true },
  computed: { title: "Computed share", field: "computed_share", unit: "", isSigned: false },
} as const;
export type Quantity = keyof typeof QUANTITIES;

export function quantityOf(name: string | undefined): Quantity | undefined {
  return name !== undefined && Object.hasOwn(QUANTITIES, name) ? (name as Quantity) : undefined;
}

type Rgb = [number, number, number];
const VIRIDIS: Rgb[] = [
  [68, 1, 84],
  [65, 68, 135],
  [42, 120, 142],
  [34, 168, 132],
  [122, 209, 81],
  [253, 231, 37],
];
/** Blue to white to brown: told apart with every kind of colour vision, white where nothing turns or swells. */
const DIVERGING: Rgb[] = [
  [0, 68, 136],
  [92, 150, 200],
  [246, 246, 246],
  [214, 140, 70],
  [130, 55, 0],
];

/** The colour at a share of the way through a scale, 0 to 1. */
export function colourAt(share: number, isSigned: boolean): string {
  const stops = isSigned ? DIVERGING : VIRIDIS;
  const at = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  const [from, to] = [stops[low] as Rgb, stops[low + 1] as Rgb];
  const mixed = from.map((value, index) => Math.round(value + (at - low) * ((to[index] as number) - value)));
  return `rgb(${mixed.join(" ")})`;
}

export type MapScale = { low: number; high: number; isSigned: boolean };

/** From zero, or from minus to plus the same, to a round number that neighbouring frames share. */
export function mapScale(values: readonly (readonly (number | null)[])[], quantity: Quantity): MapScale {
  const { isSigned } = QUANTITIES[quantity];
  if (quantity === "computed") return { low: 0, high: 1, isSigned };
  const sizes = values.flatMap((row) => row.flatMap((value) => (value === null ? [] : [Math.abs(value)])));
  sizes.sort((a, b) => a - b);
  const large = sizes[Math.floor(0.97 * (sizes.length - 1))];
  const high = large ? roundUp(large) : 1;
  return { low: isSigned ? -high : 0, high, isSigned };
}

/** Cells in their colours over the whole frame; a cell without a value lets the frame be seen. */
export function mapPainter(map: FlowMap, quantity: Quantity, scale: MapScale): Painter {
  const values = map[QUANTITIES[quantity].field];
  const [columns, rows] = [edgesOf(map.grid_x_px), edgesOf(map.grid_y_px)];
  return (pen: Pen, zoom: number) => {
    pen.globalAlpha = 1;
    values.forEach((row, j) => {
      row.forEach((value, i) => {
        if (value === null) return;
        const [left, right] = [(columns[i] as number) * zoom, (columns[i + 1] as number) * zoom];
        const [top, bottom] = [(rows[j] as number) * zoom, (rows[j + 1] as number) * zoom];
        pen.fillStyle = colourAt((value - scale.low) / (scale.high - scale.low), scale.isSigned);
        // A little wider than the cell: no hair of the frame between two cells.
        pen.fillRect(left, top, right - left + 0.6, bottom - top + 0.6);
      });
    });
  };
}

/** Edges of cells, counted from the corner of the frame, from their centres. */
export function edgesOf(centres_px: readonly number[]): number[] {
  const step = centres_px.length > 1 ? (centres_px[1] as number) - (centres_px[0] as number) : 1;
  const first = (centres_px[0] ?? 0) + 0.5 - step / 2;
  return Array.from({ length: centres_px.length + 1 }, (_, index) => first + index * step);
}

/** A map as the field that arrows are made of: cells that no droplet ever was in are interpolated. */
export function fieldOfMap(
  map: FlowMap,
): Pick<FrameFlow, "grid_x_px" | "grid_y_px" | "u_um_s" | "v_um_s" | "is_interpolated"> {
  const is_interpolated = map.computed_share.map((row) => row.map((share) => !share));
  return { ...map, is_interpolated };
}
