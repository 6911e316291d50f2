import { QueryClient } from "@tanstack/react-query";
import { ProblemError } from "./problem";

const RETRIES = 2;

/** Asking again helps when the server was away, never when it said no. */
export function isWorthRetrying(n_failures: number, error: Error): boolean {
  const status = error instanceof ProblemError ? error.problem.status : 0;
  return n_failures < RETRIES && (status === 0 || status >= 500);
}

export const queryClient = new QueryClient({
  defaultOptions: { queries: { staleTime: 5_000, retry: isWorthRetrying } },
});
