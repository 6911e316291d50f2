import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import {
  type ComparisonFigureName,
  comparisonFiguresGet,
  comparisonGet,
  experimentsList,
  runsListAll,
} from "../client";
import type { Asked } from "../results/asked";

/** Numbers, differences and figures of some runs. */
export function comparisonQuery(runs: string[]) {
  return queryOptions({
    queryKey: ["compare", runs],
    queryFn: async ({ signal }) => (await comparisonGet({ query: { run: runs }, signal })).data,
    placeholderData: keepPreviousData,
  });
}

export function comparedFigureQuery(runs: string[], name: ComparisonFigureName, asked: Asked) {
  const { from_s, to_s, radius_min_um, radius_max_um } = asked;
  const query = { run: runs, from_s, to_s, radius_min_um, radius_max_um };
  return queryOptions({
    queryKey: ["compare", "figures", name, query],
    queryFn: async ({ signal }) => (await comparisonFiguresGet({ path: { name }, query, signal })).data,
    placeholderData: keepPreviousData,
  });
}

const MOST = 500;

/** What can be compared: the newest runs that have completed, with the names of their experiments. */
export const comparableQuery = queryOptions({
  queryKey: ["compare", "runs"],
  queryFn: async ({ signal }) => {
    const [runs, experiments] = await Promise.all([
      runsListAll({ query: { limit: MOST, state: "completed" }, signal }),
      experimentsList({ query: { limit: MOST }, signal }),
    ]);
    const names = new Map(experiments.data.items.map(({ id, experiment }) => [id, String(experiment.name)]));
    return runs.data.items.map((run) => ({
      id: run.id,
      number: run.number,
      experiment: names.get(run.experiment_id) ?? "Experiment",
    }));
  },
});
