import { getRouteApi } from "@tanstack/react-router";
import { useMemo } from "react";
import type { rangesFromRelayout } from "./figure";
import { rangeFromText, rangeToText } from "./ranges";

const route = getRouteApi("/runs/$runId");

export const TABS = ["sizes", "flow", "time", "summary", "files"] as const;
export type Tab = (typeof TABS)[number];

export const LAYERS = ["now", "next", "flow", "interpolated"] as const;
export type Layer = (typeof LAYERS)[number];

/** What the address of a run's page says: the whole view, so that it can be sent. */
export type RunSearch = { tab?: Tab; frame?: number; t?: string; r?: string; hide?: Layer[] };

export function runSearch(search: Record<string, unknown>): RunSearch {
  const hide = Array.isArray(search.hide)
    ? LAYERS.filter((layer) => (search.hide as unknown[]).includes(layer))
    : [];
  return {
    tab: TABS.find((tab) => tab === search.tab),
    frame: frameOf(search),
    t: rangeFromText(asText(search.t)) && asText(search.t),
    r: rangeFromText(asText(search.r)) && asText(search.r),
    hide: hide.length > 0 ? hide : undefined,
  };
}

export function frameOf(search: Record<string, unknown>): number | undefined {
  const frame = Number(search.frame ?? Number.NaN);
  return Number.isInteger(frame) && frame >= 0 ? frame : undefined;
}

function asText(value: unknown): string | undefined {
  return typeof value === "string" ? value : undefined;
}

/** The ranges of time and radius that every plot of a run shares, kept in the address. */
export function useSharedRanges() {
  const { t, r } = route.useSearch();
  const navigate = route.useNavigate();
  const time = useMemo(() => rangeFromText(t), [t]);
  const radius = useMemo(() => rangeFromText(r), [r]);

  const change = ({ x, y }: ReturnType<typeof rangesFromRelayout>, isRadius: boolean) => {
    if (x === undefined && (y === undefined || !isRadius)) return;
    void navigate({
      search: (old) => ({
        ...old,
        t: x === undefined ? old.t : x ? rangeToText(x) : undefined,
        r: y === undefined || !isRadius ? old.r : y ? rangeToText(y) : undefined,
      }),
      replace: true,
      resetScroll: false,
    });
  };
  const clear = () =>
    navigate({
      search: (old) => ({ ...old, t: undefined, r: undefined }),
      replace: true,
      resetScroll: false,
    });
  return { time, radius, change, clear };
}
