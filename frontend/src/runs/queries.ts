import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { type Run, runsGet, runsGetReuse, runsList, schemasGetParameters } from "../client";

export function runQuery(runId: string) {
  return queryOptions({
    queryKey: ["runs", runId],
    queryFn: async ({ signal }) => (await runsGet({ path: { run_id: runId }, signal })).data,
  });
}

/** What a run took over from earlier ones; looked at again when the run has got further. */
export function reuseQuery({ id, state, stages }: Run) {
  return queryOptions({
    queryKey: ["runs", id, "reuse", state, ...stages.map((stage) => stage.state)],
    queryFn: async ({ signal }) => (await runsGetReuse({ path: { run_id: id }, signal })).data,
    placeholderData: keepPreviousData,
  });
}

/** All runs of an experiment, newest first. */
export function runsQuery(experimentId: string) {
  return queryOptions({
    queryKey: ["experiments", experimentId, "runs"],
    queryFn: async ({ signal }) => {
      const items = [];
      let cursor: string | undefined;
      do {
        const { data } = await runsList({ path: { experiment_id: experimentId }, query: { cursor }, signal });
        items.push(...data.items);
        cursor = data.next_cursor ?? undefined;
      } while (cursor);
      return items.sort((a, b) => b.number - a.number);
    },
  });
}

export const parameterSchemaQuery = queryOptions({
  queryKey: ["schemas", "parameters"],
  queryFn: async ({ signal }) => (await schemasGetParameters({ signal })).data,
  staleTime: Number.POSITIVE_INFINITY,
});
