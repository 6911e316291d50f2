import { Alert, Stack, Table, Title } from "@mantine/core";
import { isMapping } from "../forms/document";
import { type Fact, Facts } from "../platform/Facts";
import { labelAndUnit } from "../platform/units";
import { type Summary, shownNumber } from "../runs/summary";

/** What other parts of the page show. */
const ELSEWHERE = new Set(["provenance", "detected", "tracked", "flow", "warnings"]);

/** The store keeps no order: counts come first, then means, then what is measured of them. */
const ORDER = ["n_", "duration", "field", "mean", "radius", "sauter", "rms", "found", "computed"];

/** The numbers of a summary: droplets before and after tracking, trajectories, flow, and the film. */
export function SummaryNumbers({ summary }: { summary: Summary }) {
  const rest = Object.entries(summary).filter(([name]) => !ELSEWHERE.has(name));
  const isOfTrajectories = ([name]: [string, unknown]) => name.includes("traject");
  return (
    <Stack gap="md">
      <Warnings warnings={summary.warnings} />
      <BeforeAndAfter before={summary.detected} after={summary.tracked} />
      <Group title="Trajectories" entries={rest.filter(isOfTrajectories)} />
      <Group title="Flow" entries={isMapping(summary.flow) ? Object.entries(summary.flow) : []} />
      <Group title="Film" entries={rest.filter((entry) => !isOfTrajectories(entry))} />
    </Stack>
  );
}

/** What those who read the numbers should know of how they were made. */
function Warnings({ warnings }: { warnings: unknown }) {
  if (!Array.isArray(warnings)) return null;
  return warnings.filter(isMapping).map(({ code, message }) => (
    <Alert key={String(code)} color="yellow" variant="light">
      {String(message)}
    </Alert>
  ));
}

function Group({ title, entries }: { title: string; entries: [string, unknown][] }) {
  if (entries.length === 0) return null;
  const facts = inOrder(entries).flatMap(factsOf);
  return (
    <div>
      <Title order={3} mb={4}>
        {title}
      </Title>
      <Facts facts={facts} label={title} />
    </div>
  );
}

function inOrder(entries: [string, unknown][]): [string, unknown][] {
  const place = (name: string) =>
    (ORDER.findIndex((start) => name.startsWith(start)) + ORDER.length + 1) % (ORDER.length + 1);
  return [...entries].sort(([a], [b]) => place(a) - place(b));
}

/** One row a number; a group such as the rejected ones by reason, a row each. */
function factsOf([name, value]: [string, unknown]): Fact[] {
  const { label } = labelAndUnit(name);
  if (!isMapping(value)) return [[label, shownNumber(name, value)]];
  return Object.entries(value).map(([reason, number]) => [
    `${label}: ${reason.replace(/_/g, " ")}`,
    shownNumber("", number),
  ]);
}

function BeforeAndAfter({ before, after }: { before: unknown; after: unknown }) {
  if (!isMapping(before) || !isMapping(after)) return null;
  const names = inOrder(Object.entries({ ...before, ...after })).map(([name]) => name);
  return (
    <Table fz="sm" verticalSpacing={4} horizontalSpacing="xs">
      <Table.Thead>
        <Table.Tr>
          <Table.Th pl={0}>Droplets</Table.Th>
          <Table.Th ta="right">Before tracking</Table.Th>
          <Table.Th ta="right">After tracking</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {names.map((name) => (
          <Table.Tr key={name}>
            <Table.Th scope="row" fw={400} c="dimmed" pl={0}>
              {labelAndUnit(name).label}
            </Table.Th>
            <Table.Td ta="right">{name in before ? shownNumber(name, before[name]) : "–"}</Table.Td>
            <Table.Td ta="right">{name in after ? shownNumber(name, after[name]) : "–"}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}
