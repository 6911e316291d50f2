import { Anchor, Badge, Button, Grid, Group, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import type { Experiment } from "../client";
import { FramePlayer } from "../frames/FramePlayer";
import { frameSource, useStamp } from "../frames/source";
import { apiUrl } from "../platform/base";
import { Empty } from "../platform/Empty";
import { useLiveQuery } from "../platform/live";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { Loading, QueryView } from "../platform/QueryView";
import { runsQuery } from "../runs/queries";
import { RunTable } from "../runs/RunTable";
import { isActive } from "../runs/states";
import { RemoveFrames } from "../trash/RemovedFrames";
import { useUpload } from "../uploads/uploads";
import { DeleteExperiment } from "./DeleteExperiment";
import { EditExperiment } from "./EditExperiment";
import { Description, StackFacts } from "./ExperimentFacts";
import { MoveExperiment } from "./MoveExperiment";
import { experimentQuery, isChanging } from "./queries";
import { StackBadge } from "./StackBadge";
import { StackPanel } from "./StackPanel";

const route = getRouteApi("/experiments/$experimentId");

export function ExperimentPage() {
  const { experimentId } = route.useParams();
  const isSending = useUpload(experimentId) !== null;
  const query = useLiveQuery(
    experimentQuery(experimentId),
    apiUrl(["experiments", experimentId, "events"]),
    (experiment) => !isSending && !isChanging(experiment),
  );
  const experiment = query.data;
  const above = [
    <Anchor key="list" inherit renderRoot={(props) => <Link to="/" {...props} />}>
      Experiments
    </Anchor>,
  ];
  return (
    <Page
      title={String(experiment?.experiment.name ?? "Experiment")}
      above={above}
      beside={experiment && <StackBadge state={experiment.stack.state} />}
      actions={experiment && <Actions experiment={experiment} />}
    >
      <QueryView query={query} loading={<Loading rows={6} height={48} />}>
        {(loaded) => <Content experiment={loaded} />}
      </QueryView>
    </Page>
  );
}

function Actions({ experiment }: { experiment: Experiment }) {
  return (
    <>
      <EditExperiment experiment={experiment} />
      <MoveExperiment experiment={experiment} />
      <DeleteExperiment experiment={experiment} />
      {experiment.stack.state === "ready" && <AnalyseButton experimentId={experiment.id} />}
    </>
  );
}

function AnalyseButton({ experimentId }: { experimentId: string }) {
  return (
    <Button
      renderRoot={(props) => (
        <Link to="/experiments/$experimentId/analyse" params={{ experimentId }} {...props} />
      )}
    >
      New run
    </Button>
  );
}

function Content({ experiment }: { experiment: Experiment }) {
  return (
    <Grid gap="md">
      <Grid.Col span={{ base: 12, md: 8 }}>
        <Stack gap="md">
          <StackPanel experiment={experiment} />
          <Frames experiment={experiment} />
          <Runs experiment={experiment} />
        </Stack>
      </Grid.Col>
      <Grid.Col span={{ base: 12, md: 4 }}>
        <Stack gap="md">
          <Panel title="What was filmed">
            <Description experiment={experiment} />
            <Tags tags={tagsOf(experiment)} />
          </Panel>
          <Panel
            title="Stack"
            actions={experiment.stack.state === "ready" && <RemoveFrames experiment={experiment} />}
          >
            <StackFacts experiment={experiment} />
          </Panel>
        </Stack>
      </Grid.Col>
    </Grid>
  );
}

function Tags({ tags }: { tags: string[] }) {
  if (tags.length === 0) return null;
  return (
    <Group gap={6}>
      {tags.map((tag) => (
        <Badge key={tag} variant="default" tt="none" fw={400}>
          {tag}
        </Badge>
      ))}
    </Group>
  );
}

function tagsOf({ experiment }: Experiment): string[] {
  return Array.isArray(experiment.tags) ? experiment.tags.map(String) : [];
}

function Frames({ experiment }: { experiment: Experiment }) {
  const { frame = 0 } = route.useSearch();
  const navigate = route.useNavigate();
  const source = frameSource(experiment);
  const stamp = useStamp(experiment);
  if (!source) return null;
  const shown = Math.min(frame, source.n_frames - 1);
  return (
    <Panel title="Frames">
      <FramePlayer
        source={source}
        frame={shown}
        onFrame={(to) => navigate({ search: { frame: to }, replace: true, resetScroll: false })}
        label={`Frame ${shown} of ${experiment.experiment.name}`}
        timeOf={stamp}
        fileName={String(experiment.experiment.name)}
      />
    </Panel>
  );
}

const POLL_MS = 2_000;

function Runs({ experiment }: { experiment: Experiment }) {
  const query = useQuery({
    ...runsQuery(experiment.id),
    refetchInterval: ({ state }) => (state.data?.some((run) => isActive(run.state)) ? POLL_MS : false),
  });
  if (experiment.stack.state !== "ready" && experiment.n_runs === 0) return null;
  return (
    <Panel title="Runs">
      <QueryView query={query}>
        {(runs) =>
          runs.length > 0 ? (
            <RunTable runs={runs} />
          ) : (
            <Empty title="Not analysed yet" action={<AnalyseButton experimentId={experiment.id} />}>
              <Text inherit>A run finds the droplets, follows them and computes sizes and flow.</Text>
            </Empty>
          )
        }
      </QueryView>
    </Panel>
  );
}
