import { Anchor, Button, Group, SimpleGrid, Stack, Table, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { administrationGet, auditList, type Overview, type Trouble } from "../client";
import { formatBytes } from "../platform/format";
import { Moment } from "../platform/Moment";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { QueryView } from "../platform/QueryView";
import { People } from "./People";

const REFRESH_MS = 10_000;

/** The service as a whole, for those who look after it. */
export function AdministrationPage() {
  const overview = useQuery({
    queryKey: ["administration"],
    queryFn: async () => (await administrationGet()).data,
    refetchInterval: REFRESH_MS,
  });
  return (
    <Page
      title="Administration"
      actions={
        <Anchor renderRoot={(props) => <Link to="/groups" {...props} />} fz="sm">
          Groups and their room
        </Anchor>
      }
    >
      <QueryView query={overview}>{(found) => <Work overview={found} />}</QueryView>
      <People />
      <Audit />
    </Page>
  );
}

function Work({ overview }: { overview: Overview }) {
  const { queues, workers, disk, failed, slow } = overview;
  return (
    <Stack>
      <SimpleGrid cols={{ base: 1, md: 3 }}>
        <Panel title="Queues">
          <Rows
            rows={queues.map(({ name, n_waiting, n_running }) => [
              name,
              `${n_running} at work, ${n_waiting} waiting`,
            ])}
          />
        </Panel>
        <Panel title="Workers">
          {workers.length === 0 ? (
            <Text fz="sm">Nobody holds work just now.</Text>
          ) : (
            <Rows rows={workers.map(({ name, n_shards }) => [name, `${n_shards} at work`])} />
          )}
        </Panel>
        <Panel title="Disk">
          <Rows
            rows={[
              ["Frames", formatBytes(disk.frames_bytes)],
              ["Results", formatBytes(disk.results_bytes)],
              ["Free", disk.free_bytes === null ? "not said by the store" : formatBytes(disk.free_bytes)],
            ]}
          />
        </Panel>
      </SimpleGrid>
      <Panel title="Failed in the last seven days">
        <Troubles runs={failed} />
      </Panel>
      <Panel title="Running for more than six hours">
        <Troubles runs={slow} />
      </Panel>
    </Stack>
  );
}

function Rows({ rows }: { rows: [string, string][] }) {
  return (
    <Stack gap={4}>
      {rows.map(([name, value]) => (
        <Group key={name} justify="space-between" fz="sm" wrap="nowrap">
          <Text span fz="sm" style={{ overflowWrap: "anywhere" }}>
            {name}
          </Text>
          <Text span fz="sm" ta="right">
            {value}
          </Text>
        </Group>
      ))}
    </Stack>
  );
}

function Troubles({ runs }: { runs: Trouble[] }) {
  if (runs.length === 0) return <Text fz="sm">None.</Text>;
  return (
    <Table>
      <Table.Tbody>
        {runs.map((run) => (
          <Table.Tr key={run.run_id}>
            <Table.Td>
              {run.experiment_name}, run {run.number}
            </Table.Td>
            <Table.Td>{run.group_name}</Table.Td>
            <Table.Td>{run.problem?.detail}</Table.Td>
            <Table.Td>
              {(run.finished_at ?? run.started_at) && (
                <Moment time={(run.finished_at ?? run.started_at) as string} isShort />
              )}
            </Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}

function Audit() {
  const audit = useInfiniteQuery({
    queryKey: ["administration", "audit"],
    queryFn: async ({ pageParam }) => (await auditList({ query: { limit: 20, cursor: pageParam } })).data,
    initialPageParam: undefined as string | undefined,
    getNextPageParam: (page) => page.next_cursor ?? undefined,
  });
  const lines = audit.data?.pages.flatMap((page) => page.items) ?? [];
  return (
    <Panel title="Who did what">
      <Table.ScrollContainer minWidth={700}>
        <Table>
          <Table.Tbody>
            {lines.map((line) => (
              <Table.Tr key={line.id}>
                <Table.Td>
                  <Moment time={line.at} isShort />
                </Table.Td>
                <Table.Td>
                  {line.person_name}{" "}
                  <Text span c="dimmed" fz="sm">
                    {line.via}
                  </Text>
                </Table.Td>
                <Table.Td>{line.action}</Table.Td>
                <Table.Td style={{ overflowWrap: "anywhere" }} fz="sm">
                  {Object.entries(line.about)
                    .map(([name, value]) => `${name}: ${value}`)
                    .join(", ")}
                </Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </Table.ScrollContainer>
      {audit.hasNextPage && (
        <div>
          <Button
            size="xs"
            variant="default"
            loading={audit.isFetchingNextPage}
            onClick={() => audit.fetchNextPage()}
          >
            Older
          </Button>
        </div>
      )}
    </Panel>
  );
}
