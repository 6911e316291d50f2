import { getRouteApi } from "@tanstack/react-router";
import { useMemo } from "react";
import type { RangeChange, Ranges } from "../results/figure";
import { rangeFromText, rangeToText } from "../results/ranges";

export const MOST_RUNS = 8;

/** What the address of a comparison says: which runs, in their order, and the ranges that are looked at. */
export type CompareSearch = { runs?: string[]; t?: string; r?: string };

export function compareSearch(search: Record<string, unknown>): CompareSearch {
  const runs = Array.isArray(search.runs) ? search.runs.filter((run) => typeof run === "string") : [];
  const text = (value: unknown) => (typeof value === "string" && rangeFromText(value) ? value : undefined);
  return {
    runs: runs.length > 0 ? [...new Set(runs)].slice(0, MOST_RUNS) : undefined,
    t: text(search.t),
    r: text(search.r),
  };
}

const route = getRouteApi("/compare");

export function useComparison() {
  const { runs = [], t, r } = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<CompareSearch>) =>
    void navigate({ search: (old) => ({ ...old, ...part }), replace: true, resetScroll: false });
  const ranges = useMemo((): Ranges => ({ time_s: rangeFromText(t), radius_um: rangeFromText(r) }), [t, r]);
  const zoom = ({ time_s, radius_um }: RangeChange) => {
    if (time_s === undefined && radius_um === undefined) return;
    change({
      ...(time_s === undefined ? {} : { t: time_s ? rangeToText(time_s) : undefined }),
      ...(radius_um === undefined ? {} : { r: radius_um ? rangeToText(radius_um) : undefined }),
    });
  };
  return {
    runs,
    ranges,
    zoom,
    add: (run: string) => change({ runs: [...runs, run].slice(0, MOST_RUNS) }),
    remove: (run: string) => change({ runs: runs.filter((one) => one !== run) }),
    clear: () => change({ t: undefined, r: undefined }),
  };
}
