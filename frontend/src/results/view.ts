import { getRouteApi } from "@tanstack/react-router";
import { useMemo } from "react";
import { viewFromText } from "../frames/viewport";
import type { RangeChange, Ranges } from "./figure";
import { rangeFromText, rangeToText } from "./ranges";

const route = getRouteApi("/runs/$runId");

export const TABS = ["sizes", "frames", "flow", "time", "figures", "quality", "summary", "files"] as const;
export type Tab = (typeof TABS)[number];

export const LAYERS = [
  "now",
  "predicted",
  "next",
  "steps",
  "tails",
  "flow",
  "interpolated",
  "rejected",
] as const;
export type Layer = (typeof LAYERS)[number];
export const USUAL_LAYERS: Layer[] = ["now", "predicted", "next", "flow", "interpolated"];

export const COLOURINGS = ["match", "radius"] as const;
export type Colouring = (typeof COLOURINGS)[number];

/** What the address of a run's page says: the whole view, so that it can be sent. */
export type RunSearch = {
  tab?: Tab;
  frame?: number;
  /** Range of time in seconds. */
  t?: string;
  /** Range of radius in micrometres. */
  r?: string;
  /** A moment in seconds, where one is looked at. */
  at?: number;
  layers?: Layer[];
  colour?: Colouring;
  /** Part of the frame that is seen. */
  view?: string;
  /** Trajectory that is looked at. */
  droplet?: number;
  /** What is drawn below the arrows of the flow. */
  map?: string;
  /** The mean flow over the range of time instead of one step. */
  mean?: boolean;
  figure?: string;
  /** Oscillations are marked on the time axis unless this says no. */
  marks?: false;
  /** The frame as detection sees it, in place of the frame as it came. */
  prepared?: true;
};

export function runSearch(search: Record<string, unknown>): RunSearch {
  const layers = Array.isArray(search.layers)
    ? LAYERS.filter((layer) => (search.layers as unknown[]).includes(layer))
    : undefined;
  return {
    tab: TABS.find((tab) => tab === search.tab),
    frame: frameOf(search),
    t: rangeFromText(asText(search.t)) && asText(search.t),
    r: rangeFromText(asText(search.r)) && asText(search.r),
    at: asNumber(search.at),
    layers,
    colour: COLOURINGS.find((colour) => colour === search.colour),
    view: viewFromText(asText(search.view)) && asText(search.view),
    droplet: Number.isInteger(asNumber(search.droplet)) ? asNumber(search.droplet) : undefined,
    map: asText(search.map),
    mean: search.mean === true ? true : undefined,
    figure: asText(search.figure),
    marks: search.marks === false ? false : undefined,
    prepared: search.prepared === true ? true : undefined,
  };
}

export function frameOf(search: Record<string, unknown>): number | undefined {
  const frame = Number(search.frame ?? Number.NaN);
  return Number.isInteger(frame) && frame >= 0 ? frame : undefined;
}

function asText(value: unknown): string | undefined {
  return typeof value === "string" ? value : undefined;
}

function asNumber(value: unknown): number | undefined {
  return typeof value === "number" && Number.isFinite(value) ? value : undefined;
}

/** Change a part of the view; the address follows without a step in the browser's history. */
export function useView() {
  const search = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<RunSearch>) =>
    void navigate({ search: (old) => ({ ...old, ...part }), replace: true, resetScroll: false });
  return { search, change };
}

/** The ranges of time (s) and radius (um) that every plot of a run shares, kept in the address. */
export function useSharedRanges() {
  const { search, change } = useView();
  const ranges = useMemo(
    (): Ranges => ({ time_s: rangeFromText(search.t), radius_um: rangeFromText(search.r) }),
    [search.t, search.r],
  );
  const zoom = ({ time_s, radius_um }: RangeChange) => {
    if (time_s === undefined && radius_um === undefined) return;
    change({
      ...(time_s === undefined ? {} : { t: time_s ? rangeToText(time_s) : undefined }),
      ...(radius_um === undefined ? {} : { r: radius_um ? rangeToText(radius_um) : undefined }),
    });
  };
  return { ranges, zoom, clear: () => change({ t: undefined, r: undefined }) };
}
