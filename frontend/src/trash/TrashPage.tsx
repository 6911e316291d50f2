import { Button, Group, Stack, Table, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { Trash, TrashedThing } from "../client";
import { ConfirmButton } from "../platform/ConfirmButton";
import { Empty } from "../platform/Empty";
import { formatBytes, formatDate, plural } from "../platform/format";
import { Moment } from "../platform/Moment";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { trashQuery, useEmpty, useRemove, useRestore } from "./queries";

/** What was deleted and is not gone yet: how much room it takes, and the way back. */
export function TrashPage() {
  const query = useQuery(trashQuery);
  return (
    <Page title="Trash">
      <QueryView query={query}>
        {(trash) =>
          trash.items.length === 0 ? (
            <Empty title="The trash is empty">
              <Text inherit>What is deleted comes here first, and can be brought back.</Text>
            </Empty>
          ) : (
            <Content trash={trash} />
          )
        }
      </QueryView>
    </Page>
  );
}

function Content({ trash }: { trash: Trash }) {
  const empty = useEmpty();
  return (
    <Panel
      title={`${plural(trash.items.length, "thing")}, ${formatBytes(trash.size_bytes)}`}
      about="All of this still takes room, until it is removed for good."
      actions={
        <ConfirmButton
          label="Empty the trash"
          title="Empty the trash?"
          action="Remove it all"
          mutation={empty}
        >
          {plural(trash.items.length, "thing")} of your groups, {formatBytes(trash.size_bytes)}, are removed
          for good. This cannot be undone.
        </ConfirmButton>
      }
    >
      <Table.ScrollContainer minWidth={620}>
        <Table verticalSpacing="xs">
          <Table.Thead>
            <Table.Tr>
              <Table.Th>What</Table.Th>
              <Table.Th>Group</Table.Th>
              <Table.Th ta="right">Room</Table.Th>
              <Table.Th>Deleted</Table.Th>
              <Table.Th>Gone for good</Table.Th>
              <Table.Th aria-label="What can be done" />
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {trash.items.map((thing) => (
              <Row key={`${thing.kind} ${thing.run_id ?? thing.experiment_id}`} thing={thing} />
            ))}
          </Table.Tbody>
        </Table>
      </Table.ScrollContainer>
    </Panel>
  );
}

const WORDS = { experiment: "Experiment", frames: "Raw frames", run: "Run" };

function titleOf(thing: TrashedThing): string {
  return thing.kind === "run"
    ? `Run ${thing.number} of ${thing.name}`
    : `${WORDS[thing.kind]} of ${thing.name}`;
}

function Row({ thing }: { thing: TrashedThing }) {
  const restore = useRestore(thing);
  const remove = useRemove(thing);
  const title = thing.kind === "experiment" ? thing.name : titleOf(thing);
  return (
    <Table.Tr>
      <Table.Td>
        <Stack gap={0}>
          <Text fz="sm">{title}</Text>
          <Text fz="xs" c="dimmed">
            {WORDS[thing.kind]}
          </Text>
          {restore.error && <ProblemAlert problem={toProblem(restore.error)} />}
        </Stack>
      </Table.Td>
      <Table.Td>{thing.group}</Table.Td>
      <Table.Td ta="right" className="numbers">
        {formatBytes(thing.size_bytes)}
      </Table.Td>
      <Table.Td>
        <Moment time={thing.trashed_at} />
        <Text fz="xs" c="dimmed">
          {thing.trashed_by ?? "their time was over"}
        </Text>
      </Table.Td>
      <Table.Td>{thing.goes_at ? formatDate(thing.goes_at) : "when emptied"}</Table.Td>
      <Table.Td>
        <Group gap="xs" justify="flex-end" wrap="nowrap">
          <Button
            size="xs"
            variant="default"
            loading={restore.isPending}
            onClick={() => restore.mutate()}
            aria-label={`Bring back ${title}`}
          >
            Bring back
          </Button>
          <ConfirmButton
            size="xs"
            label="Remove"
            title={`Remove ${title}?`}
            action="Remove for good"
            mutation={remove}
          >
            {formatBytes(thing.size_bytes)} are freed. This cannot be undone.
          </ConfirmButton>
        </Group>
      </Table.Td>
    </Table.Tr>
  );
}
