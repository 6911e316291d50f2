import { QueryCache, QueryClient } from "@tanstack/react-query";
import { ProblemError } from "./problem";

const RETRIES = 2;

/** Asking again helps when the server was away, never when it said no. */
export function isWorthRetrying(n_failures: number, error: Error): boolean {
  const status = error instanceof ProblemError ? error.problem.status : 0;
  return n_failures < RETRIES && (status === 0 || status >= 500);
}

/** Where it says that nobody is signed in (any more), who is in is asked anew: the way in appears. */
function onError(error: Error): void {
  if (error instanceof ProblemError && error.problem.status === 401) {
    void queryClient.invalidateQueries({ queryKey: ["session"] });
  }
}

export const queryClient: QueryClient = new QueryClient({
  queryCache: new QueryCache({ onError }),
  defaultOptions: { queries: { staleTime: 5_000, retry: isWorthRetrying } },
});
