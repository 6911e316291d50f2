import { queryOptions } from "@tanstack/react-query";
import { importsLook } from "../client";

/** What frames could be imported from: the roots, or a folder below one. */
export function placeQuery(experimentId: string, root: string | null, path: string) {
  return queryOptions({
    queryKey: ["imports", experimentId, root, path],
    queryFn: async ({ signal }) =>
      (
        await importsLook({
          path: { experiment_id: experimentId },
          query: root === null ? {} : { root, path },
          signal,
        })
      ).data,
    staleTime: 10_000,
  });
}
