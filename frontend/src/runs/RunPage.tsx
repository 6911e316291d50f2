import { Alert, Anchor, Button, Group, List, Paper, Stack, Tabs } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { getRouteApi, Link, useNavigate } from "@tanstack/react-router";
import { lazy, Suspense } from "react";
import { type Experiment, type Run, runsCancel, runsDelete, runsRetry } from "../client";
import { experimentQuery } from "../experiments/queries";
import { apiUrl } from "../platform/base";
import { ConfirmButton } from "../platform/ConfirmButton";
import { useLiveQuery } from "../platform/live";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Loading, QueryView } from "../platform/QueryView";
import { TABS, type Tab } from "../results/view";
import { KeyNumbers } from "./KeyNumbers";
import { runQuery } from "./queries";
import { RunName, StateBadge } from "./RunBadges";
import { Stages } from "./StageProgress";
import { isActive } from "./states";

const SizesTab = lazy(async () => ({ default: (await import("../results/SizesTab")).SizesTab }));
const TimeTab = lazy(async () => ({ default: (await import("../results/TimeTab")).TimeTab }));
const FlowTab = lazy(async () => ({ default: (await import("../results/FlowTab")).FlowTab }));
const SummaryTab = lazy(async () => ({ default: (await import("../results/SummaryTab")).SummaryTab }));
const FilesTab = lazy(async () => ({ default: (await import("../results/FilesTab")).FilesTab }));

const route = getRouteApi("/runs/$runId");

export function RunPage() {
  const { runId } = route.useParams();
  const query = useLiveQuery(
    runQuery(runId),
    apiUrl(["runs", runId, "events"]),
    (run) => !isActive(run.state),
  );
  const run = query.data;
  const experiment = useQuery({ ...experimentQuery(run?.experiment_id ?? ""), enabled: run !== undefined });
  const name = experiment.data ? String(experiment.data.experiment.name) : "Experiment";
  const above = [
    <Anchor key="list" inherit renderRoot={(props) => <Link to="/" {...props} />}>
      Experiments
    </Anchor>,
    run && (
      <Anchor
        key="experiment"
        inherit
        renderRoot={(props) => (
          <Link to="/experiments/$experimentId" params={{ experimentId: run.experiment_id }} {...props} />
        )}
      >
        {name}
      </Anchor>
    ),
  ].filter(Boolean);
  return (
    <Page
      title={run ? `Run ${run.number} of ${name}` : "Run"}
      heading={run && <RunName number={run.number} size="inherit" />}
      above={above}
      beside={run && <StateBadge state={run.is_cancelling && isActive(run.state) ? "stopping" : run.state} />}
      actions={run && <Actions run={run} />}
    >
      <QueryView query={query} loading={<Loading rows={6} height={48} />}>
        {(loaded) => (
          <Stack gap="md">
            <Outcome run={loaded} />
            <KeyNumbers run={loaded} />
            <Results run={loaded} experiment={experiment.data} />
          </Stack>
        )}
      </QueryView>
    </Page>
  );
}

function Outcome({ run }: { run: Run }) {
  return (
    <>
      {run.problem && <ProblemAlert problem={run.problem} title="This run failed" />}
      {run.state !== "completed" && (
        <Panel title="Progress">
          <Stages stages={run.stages} />
        </Panel>
      )}
      {run.warnings.length > 0 && (
        <Alert color="orange" title="Worth knowing">
          <List size="sm">
            {run.warnings.map((warning) => (
              <List.Item key={warning}>{warning}</List.Item>
            ))}
          </List>
        </Alert>
      )}
    </>
  );
}

const TAB_TITLES: Record<Tab, string> = {
  sizes: "Sizes",
  flow: "Droplets and flow",
  time: "Over time",
  summary: "Numbers and parameters",
  files: "Downloads",
};

function Results({ run, experiment }: { run: Run; experiment: Experiment | undefined }) {
  const { tab = "sizes" } = route.useSearch();
  const navigate = route.useNavigate();
  const choose = (next: string | null) =>
    navigate({ search: (old) => ({ ...old, tab: next as Tab }), resetScroll: false });
  return (
    <Tabs value={tab} onChange={choose} keepMounted={false}>
      <Tabs.List mb="md">
        {TABS.map((name) => (
          <Tabs.Tab key={name} value={name}>
            {TAB_TITLES[name]}
          </Tabs.Tab>
        ))}
      </Tabs.List>
      <Suspense fallback={<Loading rows={1} height={420} />}>
        <Tabs.Panel value="sizes">
          <SizesTab run={run} />
        </Tabs.Panel>
        <Tabs.Panel value="flow">
          {experiment ? <FlowTab run={run} experiment={experiment} /> : <Loading rows={1} height={420} />}
        </Tabs.Panel>
        <Tabs.Panel value="time">
          <TimeTab run={run} />
        </Tabs.Panel>
        <Tabs.Panel value="summary">
          <SummaryTab run={run} />
        </Tabs.Panel>
        <Tabs.Panel value="files">
          <FilesTab run={run} />
        </Tabs.Panel>
      </Suspense>
    </Tabs>
  );
}

function Actions({ run }: { run: Run }) {
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
