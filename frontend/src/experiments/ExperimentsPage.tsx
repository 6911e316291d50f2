import { Anchor, Button, Center, Group, Progress, Table, Text } from "@mantine/core";
import { useInfiniteQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import type { Experiment, RunSummary } from "../client";
import { Empty } from "../platform/Empty";
import { formatBytes, formatCount } from "../platform/format";
import { Moment } from "../platform/Moment";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { Loading, QueryView } from "../platform/QueryView";
import { RunName, StateBadge } from "../runs/RunBadges";
import { doneShare, isActive } from "../runs/states";
import { experimentsQuery, isChanging } from "./queries";
import { StackBadge } from "./StackBadge";

const POLL_MS = 3_000;

export function ExperimentsPage() {
  const query = useInfiniteQuery({
    ...experimentsQuery,
    refetchInterval: ({ state }) =>
      state.data?.pages.some(({ items }) => items.some(isChanging)) ? POLL_MS : false,
  });
  return (
    <Page title="Experiments">
      <QueryView query={query} loading={<Loading rows={5} height={44} />}>
        {({ pages }) => {
          const experiments = pages.flatMap(({ items }) => items);
          if (experiments.length === 0) return <NoExperiments />;
          return (
            <>
              <ExperimentTable experiments={experiments} />
              {query.hasNextPage && (
                <Center>
                  <Button
                    variant="default"
                    loading={query.isFetchingNextPage}
                    onClick={() => query.fetchNextPage()}
                  >
                    Show more
                  </Button>
                </Center>
              )}
            </>
          );
        }}
      </QueryView>
    </Page>
  );
}

function NoExperiments() {
  return (
    <Panel title="Start here">
      <Empty
        title="No experiments yet"
        action={
          <Button mt="sm" renderRoot={(props) => <Link to="/experiments/new" {...props} />}>
            New experiment
          </Button>
        }
      >
        Say what was filmed, drop a folder of frames, and see droplet sizes and the flow field.
      </Empty>
    </Panel>
  );
}

function ExperimentTable({ experiments }: { experiments: Experiment[] }) {
  const isGroupShown = new Set(experiments.map(({ group }) => group.id)).size > 1;
  return (
    <Table.ScrollContainer
      minWidth={720}
      type="native"
      tabIndex={0}
      role="region"
      aria-label="Table of experiments"
    >
      <Table verticalSpacing="sm" highlightOnHover className="on-paper">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Experiment</Table.Th>
            <Table.Th>Frames</Table.Th>
            <Table.Th>Latest run</Table.Th>
            <Table.Th ta="right">Droplets</Table.Th>
            <Table.Th>Created</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {experiments.map((experiment) => (
            <ExperimentRow key={experiment.id} experiment={experiment} isGroupShown={isGroupShown} />
          ))}
        </Table.Tbody>
      </Table>
    </Table.ScrollContainer>
  );
}

function ExperimentRow({ experiment, isGroupShown }: { experiment: Experiment; isGroupShown: boolean }) {
  const { stack, latest_run: run } = experiment;
  return (
    <Table.Tr>
      <Table.Td maw={420}>
        <Anchor
          fw={500}
          style={{ overflowWrap: "anywhere" }}
          renderRoot={(props) => (
            <Link to="/experiments/$experimentId" params={{ experimentId: experiment.id }} {...props} />
          )}
        >
          {String(experiment.experiment.name ?? "Without a name")}
        </Anchor>
        {isGroupShown && (
          <Text fz="xs" c="dimmed">
            {experiment.group.name}
          </Text>
        )}
      </Table.Td>
      <Table.Td>
        {stack.state === "ready" ? (
          <>
            {formatCount(stack.n_frames)}
            <Text fz="xs" c="dimmed">
              {formatBytes(stack.size_bytes)}
            </Text>
          </>
        ) : (
          <StackBadge state={stack.state} />
        )}
      </Table.Td>
      <Table.Td>
        {run ? (
          <LatestRun run={run} n_runs={experiment.n_runs} />
        ) : (
          <Text c="dimmed" fz="sm">
            none
          </Text>
        )}
      </Table.Td>
      <Table.Td ta="right">{formatCount(run?.n_droplets)}</Table.Td>
      <Table.Td>
        <Moment time={experiment.created_at} isShort />
      </Table.Td>
    </Table.Tr>
  );
}

function LatestRun({ run, n_runs }: { run: RunSummary; n_runs: number }) {
  const percent = Math.floor(100 * doneShare(run.stages ?? []));
  return (
    <>
      <Group gap="xs" wrap="nowrap">
        <Anchor
          c="inherit"
          renderRoot={(props) => <Link to="/runs/$runId" params={{ runId: run.id }} {...props} />}
        >
          <RunName number={run.number} />
        </Anchor>
        <StateBadge state={run.state} />
        {n_runs > 1 && (
          <Text fz="xs" c="dimmed">
            of {n_runs}
          </Text>
        )}
      </Group>
      {isActive(run.state) && (
        <Group gap={8} wrap="nowrap" mt={4}>
          <Progress value={percent} w={110} size="sm" aria-label={`Run ${run.number}: ${percent} % done`} />
          <Text fz="xs" c="dimmed" className="numbers">
            {percent} %
          </Text>
        </Group>
      )}
    </>
  );
}
