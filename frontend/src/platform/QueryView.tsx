import { Alert, Button, Skeleton, Stack } from "@mantine/core";
import type { UseQueryResult } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import { ProblemAlert } from "./ProblemAlert";
import { toProblem } from "./problem";

type QueryViewProps<Data> = {
  query: Pick<UseQueryResult<Data>, "data" | "error" | "isPending" | "refetch" | "isFetching">;
  loading?: ReactNode;
  children: (data: Data) => ReactNode;
};

/** Loading, error with a way on, or the data; data that is there stays while a later question fails. */
export function QueryView<Data>({ query, loading, children }: QueryViewProps<Data>) {
  if (query.data !== undefined) {
    return (
      <>
        {query.error && <MayBeOld error={query.error} />}
        {children(query.data)}
      </>
    );
  }
  if (query.error) {
    return (
      <ProblemAlert problem={toProblem(query.error)}>
        <div>
          {toProblem(query.error).status === 404 ? (
            <Button size="xs" variant="default" renderRoot={(props) => <Link to="/" {...props} />}>
              All experiments
            </Button>
          ) : (
            <Button size="xs" variant="default" loading={query.isFetching} onClick={() => query.refetch()}>
              Try again
            </Button>
          )}
        </div>
      </ProblemAlert>
    );
  }
  return loading ?? <Loading />;
}

function MayBeOld({ error }: { error: Error }) {
  return (
    <Alert color="orange" role="status" p="xs" mb="sm">
      {toProblem(error).detail} What you see may be old; it is asked for again.
    </Alert>
  );
}

export function Loading({ rows = 3, height = 20 }: { rows?: number; height?: number }) {
  return (
    <Stack gap="xs" role="status" aria-label="Loading">
      {Array.from({ length: rows }, (_, row) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: rows of a placeholder have no identity
        <Skeleton key={row} height={height} radius="sm" />
      ))}
    </Stack>
  );
}
