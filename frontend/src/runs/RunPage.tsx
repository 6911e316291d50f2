import { Alert, Anchor, List, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import type { Run } from "../client";
import { experimentQuery } from "../experiments/queries";
import { apiUrl } from "../platform/base";
import { useLiveQuery } from "../platform/live";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { Loading, QueryView } from "../platform/QueryView";
import { ResultTabs } from "../results/ResultTabs";
import { KeyNumbers } from "./KeyNumbers";
import { runQuery } from "./queries";
import { ReuseNote } from "./ReuseNote";
import { RunActions } from "./RunActions";
import { RunName, StateBadge } from "./RunBadges";
import { Stages } from "./StageProgress";
import { isActive } from "./states";
import { nDroplets } from "./summary";

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
      actions={run && <RunActions run={run} />}
    >
      <QueryView query={query} loading={<Loading rows={6} height={48} />}>
        {(loaded) => (
          <Stack gap="md">
            <Outcome run={loaded} />
            {experiment.data?.stack.n_frames === 1 && <OneFrame />}
            {nDroplets(loaded.summary) === 0 && <NoDroplets />}
            <KeyNumbers run={loaded} />
            <ResultTabs run={loaded} experiment={experiment.data} />
          </Stack>
        )}
      </QueryView>
    </Page>
  );
}

/** What moves, grows or lasts cannot be seen in one frame; said once, for all the empty plots below. */
function OneFrame() {
  return (
    <Alert color="blue" role="status" title="A film of one frame">
      Droplets are found and their sizes shown as detected. Nothing can be followed, so that whatever needs
      motion or time stays empty: trajectories, flow, growth. For these, make a new experiment with two frames
      or more.
    </Alert>
  );
}

/** Nothing went wrong, and all is empty: what usually is the reason. */
function NoDroplets() {
  return (
    <Alert color="orange" role="status" title="No droplet was found">
      Look at the frames under “Droplets”. If droplets can be seen there, see whether the experiment says
      rightly that they are bright or dark, and what size a pixel has; then choose “Run with other
      parameters”: its preview shows what is found and why the rest is rejected.
    </Alert>
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
      <ReuseNote run={run} />
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
