import { useQuery } from "@tanstack/react-query";
import { useMemo } from "react";
import type { Run } from "../client";
import { isMapping } from "../forms/document";
import { type Figure, type Mark, marksFrom, type Range } from "./figure";
import { catalogueQuery, figureQuery } from "./queries";

const NONE: readonly Mark[] = [];

/** The time axis that all plots of a run share: from first to last frame, with the peaks of the oscillations. */
export function useTimeAxis(run: Run, isMarked: boolean) {
  const catalogue = useQuery(catalogueQuery(run));
  const isThere = catalogue.data?.find(({ name }) => name === "oscillations")?.is_available ?? false;
  const query = useQuery({ ...figureQuery(run, "oscillations"), enabled: isThere });
  const found = useMemo(() => (query.data ? marksFrom(query.data as unknown as Figure) : null), [query.data]);
  const duration_s = isMapping(run.summary) ? run.summary.duration_s : undefined;
  const aligned_s = useMemo(
    (): Range | undefined =>
      typeof duration_s === "number" && duration_s > 0 ? [-0.01 * duration_s, 1.01 * duration_s] : undefined,
    [duration_s],
  );
  return {
    aligned_s,
    marks: isMarked ? (found ?? NONE) : NONE,
    /** How many oscillations stand out; null until it is known. */
    n_marks: found?.length ?? null,
  };
}
