import { Stack, Table, Text, Title } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useMemo } from "react";
import { type Document, valueAt } from "../forms/document";
import { type Field, fieldsOf, type JsonSchema } from "../forms/schema";
import { formatNumber } from "../platform/format";
import { QueryView } from "../platform/QueryView";
import { isInUse } from "../runs/ParameterForm";
import { parameterSchemaQuery } from "../runs/queries";

/** The parameters of a run beside the paper's, in the order of the form; what differs from the default stands out. */
export function ParameterTable({ parameters }: { parameters: Document }) {
  const schema = useQuery(parameterSchemaQuery);
  return (
    <QueryView query={schema}>
      {(loaded) => <Stages schema={loaded as JsonSchema} parameters={parameters} />}
    </QueryView>
  );
}

function Stages({ schema, parameters }: { schema: JsonSchema; parameters: Document }) {
  const stages = useMemo(() => fieldsOf(schema), [schema]);
  return (
    <Stack gap="md">
      {stages.map((stage) => (
        <div key={stage.path}>
          <Title order={3}>{stage.label}</Title>
          <Table fz="sm" verticalSpacing={4} horizontalSpacing="xs" aria-label={stage.label}>
            <Table.Thead>
              <Table.Tr>
                <Table.Th pl={0}>Parameter</Table.Th>
                <Table.Th ta="right">This run</Table.Th>
                <Table.Th ta="right">Paper</Table.Th>
              </Table.Tr>
            </Table.Thead>
            <Table.Tbody>
              {leavesOf(stage, parameters)
                .filter(({ path }) => valueAt(parameters, path) !== undefined)
                .map((field) => (
                  <ParameterRow key={field.path} field={field} value={valueAt(parameters, field.path)} />
                ))}
            </Table.Tbody>
          </Table>
        </div>
      ))}
    </Stack>
  );
}

function ParameterRow({ field, value }: { field: Field; value: unknown }) {
  const isChanged = field.fallback !== undefined && field.fallback !== value;
  return (
    <Table.Tr>
      <Table.Th scope="row" fw={400} c="dimmed" pl={0}>
        {field.label}
        {field.unit && ` (${field.unit})`}
      </Table.Th>
      <Table.Td ta="right">
        <Text span fz="sm" fw={isChanged ? 700 : 400}>
          {shownValue(value)}
        </Text>
        {isChanged && (
          <Text span fz="xs" c="dimmed" display="block">
            default {shownValue(field.fallback)}
          </Text>
        )}
      </Table.Td>
      <Table.Td ta="right">{field.paper ? shownValue(field.paper.value) : ""}</Table.Td>
    </Table.Tr>
  );
}

function shownValue(value: unknown): string {
  return typeof value === "number" ? formatNumber(value, 6) : String(value);
}

function leavesOf(field: Field, parameters: Document): Field[] {
  if (field.input.kind !== "group") return [field];
  const { fields } = field.input;
  return fields.filter((one) => isInUse(one, fields, parameters)).flatMap((one) => leavesOf(one, parameters));
}
