import { infiniteQueryOptions, queryOptions } from "@tanstack/react-query";
import { type Experiment, experimentsGet, experimentsList, schemasGetExperiment } from "../client";
import { isActive } from "../runs/states";

const PAGE = 50;

export const experimentsQuery = infiniteQueryOptions({
  queryKey: ["experiments"],
  queryFn: async ({ pageParam, signal }) =>
    (await experimentsList({ query: { limit: PAGE, cursor: pageParam }, signal })).data,
  initialPageParam: undefined as string | undefined,
  getNextPageParam: (page) => page.next_cursor ?? undefined,
});

export function experimentQuery(experimentId: string) {
  return queryOptions({
    queryKey: ["experiments", experimentId],
    queryFn: async ({ signal }) =>
      (await experimentsGet({ path: { experiment_id: experimentId }, signal })).data,
  });
}

export const experimentSchemaQuery = queryOptions({
  queryKey: ["schemas", "experiment"],
  queryFn: async ({ signal }) => (await schemasGetExperiment({ signal })).data,
  staleTime: Number.POSITIVE_INFINITY,
});

/** Whether something goes on that this page should follow. */
export function isChanging(experiment: Experiment): boolean {
  const { state } = experiment.stack;
  const run = experiment.latest_run;
  return state === "uploading" || state === "indexing" || (run != null && isActive(run.state));
}
