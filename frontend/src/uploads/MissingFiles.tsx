import { Button, Stack, Text } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { type Experiment, stackComplete, uploadsList } from "../client";
import { formatBytes, plural } from "../platform/format";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";

const POLL_MS = 3_000;

/** What was announced and has not arrived, and going on with what did. */
export function MissingFiles({ experiment }: { experiment: Experiment }) {
  const { id, stack } = experiment;
  const cache = useQueryClient();
  const path = { experiment_id: id };
  const { data } = useQuery({
    queryKey: ["experiments", id, "uploads"],
    queryFn: async ({ signal }) => (await uploadsList({ path, signal })).data,
    refetchInterval: POLL_MS,
  });
  const go_on = useMutation({
    mutationFn: async () => (await stackComplete({ path, query: { missing: "leave_out" } })).data,
    onSuccess: (changed) => cache.setQueryData(["experiments", id], changed),
  });
  if (!data) return null;
  return (
    <Stack gap="xs" align="flex-start">
      {data.n_files_missing > 0 && (
        <Text fz="sm" role="status">
          {plural(data.n_files_missing, "announced file")} ({formatBytes(data.n_bytes_missing)} of them) have
          not arrived.
        </Text>
      )}
      {stack.n_files > 0 && (
        <Button size="xs" variant="default" loading={go_on.isPending} onClick={() => go_on.mutate()}>
          Go on with the {plural(stack.n_files, "file")} that arrived
        </Button>
      )}
      {go_on.error && <ProblemAlert problem={toProblem(go_on.error)} />}
    </Stack>
  );
}
