import { Button, Group, Paper } from "@mantine/core";
import { type UseMutationResult, useMutation, useQueryClient } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { type Run, runsCancel, runsDelete, runsRetry } from "../client";
import { ConfirmButton } from "../platform/ConfirmButton";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { ShareRun } from "./ShareRun";
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
      void cache.invalidateQueries({ queryKey: ["trash"] });
    },
  });
  const error = retry.error;
  return (
    <Group gap="xs">
      {error && (
        <Paper maw={420}>
          <ProblemAlert problem={toProblem(error)} />
        </Paper>
      )}
      {isActive(run.state) ? (
        <CancelButton run={run} cancel={cancel} />
      ) : (
        <ConfirmButton
          label="Delete"
          title={`Delete run ${run.number}?`}
          action="Delete the run"
          mutation={remove}
        >
          Its results go to the trash, where they take room until it is emptied, and can be brought back as
          long. The frames stay.
        </ConfirmButton>
      )}
      <ShareRun runId={run.id} />
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

function CancelButton({ run, cancel }: { run: Run; cancel: UseMutationResult<Run, Error, void> }) {
  if (run.is_cancelling)
    return (
      <Button variant="default" disabled>
        Stopping
      </Button>
    );
  return (
    <ConfirmButton
      label="Cancel the run"
      title={`Cancel run ${run.number}?`}
      action="Cancel the run"
      mutation={cancel}
    >
      It stops within seconds. What it has made so far is removed, unless another run shares it; the frames
      stay.
    </ConfirmButton>
  );
}
