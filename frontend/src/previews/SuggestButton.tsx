import { Alert, Button, List, Modal, Stack, Table, Text } from "@mantine/core";
import { IconWand } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { type Suggestions, suggestionsCreate } from "../client";
import { type Document, withValue } from "../forms/document";
import { plainField } from "../platform/fields";
import { formatNumber } from "../platform/format";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { readableUnit } from "../platform/units";

type SuggestButtonProps = {
  experimentId: string;
  parameters: Document;
  onTake: (parameters: Document) => void;
};

/** Measure the frames, say what was measured and what it speaks for, and take it over with one click. */
export function SuggestButton({ experimentId, parameters, onTake }: SuggestButtonProps) {
  const ask = useMutation({
    mutationFn: async () => (await suggestionsCreate({ path: { experiment_id: experimentId } })).data,
  });
  const take = (found: Suggestions) => {
    onTake(
      found.suggestions.reduce((document, { field, value }) => withValue(document, field, value), parameters),
    );
    ask.reset();
  };
  return (
    <>
      <Button
        variant="default"
        leftSection={<IconWand size={16} aria-hidden />}
        loading={ask.isPending}
        onClick={() => ask.mutate()}
      >
        Suggest from the frames
      </Button>
      <Modal
        opened={ask.isSuccess || ask.isError}
        onClose={ask.reset}
        title="What the frames speak for"
        size="lg"
      >
        {ask.error && <ProblemAlert problem={toProblem(ask.error)} title="Nothing could be suggested" />}
        {ask.data && <Found found={ask.data} onTake={() => take(ask.data)} />}
      </Modal>
    </>
  );
}

function Found({ found, onTake }: { found: Suggestions; onTake: () => void }) {
  return (
    <Stack gap="md">
      {found.warnings.length > 0 && (
        <Alert color="orange" title="Careful">
          <List size="sm">
            {found.warnings.map((warning) => (
              <List.Item key={warning}>{warning}</List.Item>
            ))}
          </List>
        </Alert>
      )}
      {found.suggestions.length > 0 ? (
        <Table fz="sm" aria-label="Suggested values">
          <Table.Tbody>
            {found.suggestions.map(({ field, value, unit, reason }) => (
              <Table.Tr key={field}>
                <Table.Th scope="row">{plainField(field)}</Table.Th>
                <Table.Td style={{ whiteSpace: "nowrap" }}>
                  <b>{shown(value)}</b> {readableUnit(unit)}
                </Table.Td>
                <Table.Td c="dimmed">{reason}</Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      ) : (
        <Text>The values that stand there fit these frames: nothing to change.</Text>
      )}
      <Table fz="xs" verticalSpacing={2} aria-label="Measured on the frames">
        <Table.Tbody>
          {found.measurements.map(({ name, value, unit, about }) => (
            <Table.Tr key={name}>
              <Table.Th scope="row" fw={500}>
                {name.replace(/_/g, " ")}
              </Table.Th>
              <Table.Td style={{ whiteSpace: "nowrap" }}>
                {value === null ? "not seen" : `${formatNumber(value)} ${readableUnit(unit)}`}
              </Table.Td>
              <Table.Td c="dimmed">{about}</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
      {found.suggestions.length > 0 && (
        <Button onClick={onTake} style={{ alignSelf: "flex-end" }}>
          Take these values
        </Button>
      )}
    </Stack>
  );
}

function shown(value: number | string): string {
  return typeof value === "number" ? formatNumber(value, 4) : value;
}
