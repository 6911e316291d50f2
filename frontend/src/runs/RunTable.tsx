import { Anchor, Button, Checkbox, Group, Progress, Stack, Table, Text } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import type { Run } from "../client";
import { MOST_RUNS } from "../compare/address";
import { formatCount, plural } from "../platform/format";
import { Moment } from "../platform/Moment";
import { differing } from "./differing";
import { RunName, StateBadge } from "./RunBadges";
import { doneShare, isActive } from "./states";
import { nDroplets } from "./summary";

/** The runs of an experiment; of their parameters only what tells them apart. */
export function RunTable({ runs }: { runs: Run[] }) {
  const differences = differing(runs.map(({ parameters }) => parameters));
  const [chosen, setChosen] = useState<readonly string[]>([]);
  const toggle = (id: string) =>
    setChosen(chosen.includes(id) ? chosen.filter((one) => one !== id) : [...chosen, id].slice(-MOST_RUNS));
  const hasChoice = runs.length > 1;
  return (
    <Stack gap="xs">
      {hasChoice && (
        <CompareButton
          runs={chosen.length > 0 ? chosen : runs.slice(0, MOST_RUNS).map(({ id }) => id)}
          isAll={chosen.length === 0}
        />
      )}
      <Table.ScrollContainer
        minWidth={560}
        type="native"
        tabIndex={0}
        role="region"
        aria-label="Table of runs"
      >
        <Table verticalSpacing="xs" highlightOnHover>
          <Table.Thead>
            <Table.Tr>
              {hasChoice && <Table.Td w={36} />}
              <Table.Th>Run</Table.Th>
              <Table.Th>State</Table.Th>
              {hasChoice && <Table.Th>Parameters that differ</Table.Th>}
              <Table.Th ta="right">Droplets</Table.Th>
              <Table.Th>Started</Table.Th>
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {runs.map((run, index) => (
              <Table.Tr key={run.id}>
                {hasChoice && (
                  <Table.Td>
                    <Checkbox
                      size="xs"
                      aria-label={`Compare run ${run.number}`}
                      checked={chosen.includes(run.id)}
                      onChange={() => toggle(run.id)}
                    />
                  </Table.Td>
                )}
                <Table.Td>
                  <Anchor
                    renderRoot={(props) => <Link to="/runs/$runId" params={{ runId: run.id }} {...props} />}
                  >
                    <RunName number={run.number} />
                  </Anchor>
                </Table.Td>
                <Table.Td>
                  <RunState run={run} />
                </Table.Td>
                {hasChoice && (
                  <Table.Td>
                    <Differences of={differences[index] ?? []} />
                  </Table.Td>
                )}
                <Table.Td ta="right">{formatCount(nDroplets(run.summary))}</Table.Td>
                <Table.Td>
                  <Moment time={run.created_at} isShort />
                </Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </Table.ScrollContainer>
    </Stack>
  );
}

/** The way to what was chosen; to the newest runs where nothing was. */
function CompareButton({ runs, isAll }: { runs: readonly string[]; isAll: boolean }) {
  const what = isAll ? "these runs" : plural(runs.length, "run");
  return (
    <Group justify="flex-end">
      <Button
        size="xs"
        variant="default"
        renderRoot={(props) => <Link to="/compare" search={{ runs: [...runs] }} {...props} />}
      >
        Compare {what}
      </Button>
    </Group>
  );
}

function RunState({ run }: { run: Run }) {
  if (!isActive(run.state)) return <StateBadge state={run.state} />;
  const percent = Math.floor(100 * doneShare(run.stages));
  return (
    <Group gap="xs" wrap="nowrap">
      <StateBadge state={run.state} />
      <Progress value={percent} w={80} size="sm" aria-label={`Run ${run.number}: ${percent} % done`} />
      <Text fz="xs" c="dimmed" className="numbers">
        {percent} %
      </Text>
    </Group>
  );
}

function Differences({ of }: { of: { path: string; label: string; value: string }[] }) {
  if (of.length === 0)
    return (
      <Text fz="sm" c="dimmed">
        none
      </Text>
    );
  return of.map(({ path, label, value }) => (
    <Text key={path} fz="sm">
      {label}: <b>{value}</b>
    </Text>
  ));
}
