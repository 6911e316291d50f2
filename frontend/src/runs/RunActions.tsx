import { Button, Group, Paper } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { type Run, runsCancel, runsDelete, runsRetry } from "../client";
import { ConfirmButton } from "../platform/ConfirmButton";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { isActive } from "./states";

/** What can be done with a run as a whole. */
export function RunActions({ run }: { run: Run }) {
  const cache = useQueryClient();
  const navigate = useNavigate();
  const keep = (changed: Run) => {
    cache.setQueryData(["runs", changed.id], changed);
    void cache.invalidateQueries({ queryKey: ["experiments"] });
  };
  const cancel = useMutation({
    mutationFn: async () => (await runsCancel({ path: { run_id: run.id } })).data,
    onSuccess: keep,
  });
  const retry = useMutation({
    mutationFn: async () => (await runsRetry({ path: { run_id: run.id } })).data,
    onSuccess: (again) => {
      keep(again);
      void navigate({ to: "/runs/$runId", params: { runId: again.id } });
    },
  });
  const remove = useMutation({
    mutationFn: () => runsDelete({ path: { run_id: run.id } }),
    onSuccess: async () => {
      await navigate({ to: "/experiments/$experimentId", params: { experimentId: run.experiment_id } });
      cache.removeQueries({ queryKey: ["runs", run.id] });
      void cache.invalidateQueries({ queryKey: ["experiments"] });
    },
  });
  const error = cancel.error ?? retry.error;
  return (
    <Group gap="xs">
      {error && (
        <Paper maw={420}>
          <ProblemAlert problem={toProblem(error)} />
        </Paper>
      )}
      {isActive(run.state) ? (
        <Button
          variant="default"
          disabled={run.is_cancelling}
          loading={cancel.isPending}
          onClick={() => cancel.mutate()}
        >
          {run.is_cancelling ? "Stopping" : "Cancel the run"}
        </Button>
      ) : (
        <ConfirmButton
          label="Delete"
          title={`Delete run ${run.number}?`}
          action="Delete the run"
          mutation={remove}
        >
          Its results are removed; the frames stay. This cannot be undone.
        </ConfirmButton>
      )}
      {run.state === "failed" && (
        <Button loading={retry.isPending} onClick={() => retry.mutate()}>
          Try again
        </Button>
      )}
      <Button
        variant={run.state === "failed" ? "default" : "filled"}
        renderRoot={(props) => (
          <Link
            to="/experiments/$experimentId/analyse"
            params={{ experimentId: run.experiment_id }}
            search={{ from: run.id }}
            {...props}
          />
        )}
      >
        Run with other parameters
      </Button>
    </Group>
  );
}
