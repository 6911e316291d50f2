import { ActionIcon, Anchor, Group, Select, Text } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import type { ComparedRun, Comparison } from "../client";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { MOST_RUNS, useComparison } from "./address";
import { comparableQuery } from "./queries";

/** The runs that are compared, each in its colour, and the way to another one. */
export function RunChooser({ comparison }: { comparison: Comparison | undefined }) {
  const { runs, add, remove } = useComparison();
  const query = useQuery(comparableQuery);
  const offered = (query.data ?? []).filter(({ id }) => !runs.includes(id));
  const groups = [...new Set(offered.map(({ experiment }) => experiment))].map((group) => ({
    group,
    items: offered
      .filter(({ experiment }) => experiment === group)
      .map(({ id, number }) => ({ value: id, label: `${group}: run ${number}` })),
  }));
  return (
    <Group gap="xs" align="center">
      {query.error && <ProblemAlert problem={toProblem(query.error)} title="No list of runs" />}
      {comparison?.runs
        .filter(({ id }) => runs.includes(id))
        .map((run) => (
          <Chosen key={run.id} run={run} onRemove={() => remove(run.id)} />
        ))}
      <Select
        aria-label="Add a run"
        placeholder={runs.length < MOST_RUNS ? "Add a run" : "Eight runs are as many as can be told apart"}
        disabled={runs.length >= MOST_RUNS}
        w={320}
        searchable
        data={groups}
        value={null}
        onChange={(id) => id && add(id)}
        nothingFoundMessage={query.isPending ? "Loading" : "No other completed run"}
      />
    </Group>
  );
}

function Chosen({ run, onRemove }: { run: ComparedRun; onRemove: () => void }) {
  const label = `${run.experiment_name}: run ${run.number}`;
  return (
    <Group gap={6} wrap="nowrap" className="on-paper" px={10} h={36}>
      <Dot colour={run.colour} />
      <Anchor
        fz="sm"
        renderRoot={(props) => <Link to="/runs/$runId" params={{ runId: run.id }} {...props} />}
      >
        Run {run.number}
      </Anchor>
      <Text fz="sm" c="dimmed" maw={200} truncate title={run.experiment_name}>
        {run.experiment_name}
      </Text>
      <ActionIcon
        variant="subtle"
        color="gray"
        size="sm"
        aria-label={`Leave out ${label}`}
        onClick={onRemove}
      >
        <IconX size={14} aria-hidden />
      </ActionIcon>
    </Group>
  );
}

export function Dot({ colour }: { colour: string }) {
  return (
    <span
      aria-hidden
      style={{
        width: 10,
        height: 10,
        borderRadius: "50%",
        background: colour,
        flex: "none",
        display: "inline-block",
      }}
    />
  );
}
