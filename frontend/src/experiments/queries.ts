import { infiniteQueryOptions, queryOptions } from "@tanstack/react-query";
import { type Experiment, experimentsGet, experimentsList, filesList, schemasGetExperiment } from "../client";
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

/** Every uploaded file, all pages of them. */
export async function allFiles(experimentId: string, signal?: AbortSignal) {
  const items = [];
  let cursor: string | undefined;
  do {
    const { data } = await filesList({ path: { experiment_id: experimentId }, query: { cursor }, signal });
    items.push(...data.items);
    cursor = data.next_cursor ?? undefined;
  } while (cursor);
  return items;
}

/** Whether something goes on that this page should follow. */
export function isChanging(experiment: Experiment): boolean {
  const { state } = experiment.stack;
  const run = experiment.latest_run;
  return state === "uploading" || state === "indexing" || (run != null && isActive(run.state));
}
