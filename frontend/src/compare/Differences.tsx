import { Group, Table, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { ReactNode } from "react";
import type { ComparedRun, Comparison } from "../client";
import { experimentSchemaQuery } from "../experiments/queries";
import { type Field, fieldsOf, type JsonSchema } from "../forms/schema";
import { fieldAt, inWords } from "../forms/words";
import { plainField } from "../platform/fields";
import { formatNumber } from "../platform/format";
import { Panel } from "../platform/Panel";
import { readableUnit } from "../platform/units";
import { shown } from "../runs/differing";
import { Dot } from "./RunChooser";

/** In what the runs differ, and nothing else. */
export function Differences({ comparison }: { comparison: Comparison }) {
  const { runs, parameters, experiment } = comparison;
  const schema = useQuery(experimentSchemaQuery);
  if (runs.length < 2) return null;
  const fields = schema.data ? fieldsOf(schema.data as JsonSchema) : [];
  const rows = [...parameters, ...experiment.filter(({ name }) => name !== "name")];
  return (
    <Panel title="What differs" about="Parameters and descriptions in which not all of these runs are alike.">
      {rows.length === 0 ? (
        <Text fz="sm">Nothing: same parameters, same description.</Text>
      ) : (
        <RunColumns runs={runs} label="Table of what differs">
          {rows.map(({ name, values }) => (
            <Table.Tr key={name}>
              <Table.Th scope="row" fw={500}>
                {fieldAt(fields, name)?.label ?? plainField(name)}
              </Table.Th>
              {runs.map((run, index) => (
                <Table.Td key={run.id}>{inCell(fieldAt(fields, name), name, values[index])}</Table.Td>
              ))}
            </Table.Tr>
          ))}
        </RunColumns>
      )}
    </Panel>
  );
}

function inCell(field: Field | undefined, name: string, value: unknown): string {
  if (value === null || value === undefined) return "–";
  return field ? inWords(field, value) : shown(name, value);
}

/** The numbers of all runs, a column each. */
export function ComparedNumbers({ comparison: { runs, numbers } }: { comparison: Comparison }) {
  if (numbers.length === 0) return null;
  return (
    <Panel title="Numbers" about="With their standard error, where there is one.">
      <RunColumns runs={runs} label="Table of numbers">
        {numbers.map(({ name, title, unit, values, stds }) => (
          <Table.Tr key={name}>
            <Table.Th scope="row" fw={500}>
              {title}
              {unit && (
                <Text span fz="xs" c="dimmed">
                  {" "}
                  {readableUnit(unit)}
                </Text>
              )}
            </Table.Th>
            {runs.map((run, index) => (
              <Table.Td key={run.id} className="numbers">
                {withError(values[index], stds?.[index])}
              </Table.Td>
            ))}
          </Table.Tr>
        ))}
      </RunColumns>
    </Panel>
  );
}

function withError(value: number | null | undefined, std: number | null | undefined): string {
  if (value == null) return "–";
  return std == null ? formatNumber(value, 4) : `${formatNumber(value, 4)} ± ${formatNumber(std, 2)}`;
}

function RunColumns({ runs, label, children }: { runs: ComparedRun[]; label: string; children: ReactNode }) {
  return (
    <Table.ScrollContainer
      minWidth={220 + 130 * runs.length}
      type="native"
      tabIndex={0}
      role="region"
      aria-label={label}
    >
      <Table fz="sm" verticalSpacing={6}>
        <Table.Thead>
          <Table.Tr>
            <Table.Td />
            {runs.map((run) => (
              <Table.Th key={run.id} scope="col">
                <Group gap={6} wrap="nowrap">
                  <Dot colour={run.colour} />
                  {run.label}
                </Group>
              </Table.Th>
            ))}
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>{children}</Table.Tbody>
      </Table>
    </Table.ScrollContainer>
  );
}
