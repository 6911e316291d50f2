import { Button, Group, Modal, Stack, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useMemo, useState } from "react";
import { type Experiment, experimentsUpdate } from "../client";
import { check } from "../forms/check";
import type { Document } from "../forms/document";
import { fieldsOf, type JsonSchema } from "../forms/schema";
import { ProblemAlert } from "../platform/ProblemAlert";
import { fieldMessages, toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { isActive } from "../runs/states";
import { ExperimentForm } from "./ExperimentForm";
import { experimentSchemaQuery } from "./queries";

/** Correct the description; runs that are there keep the one they were made with. */
export function EditExperiment({ experiment }: { experiment: Experiment }) {
  const [isOpen, { open, close }] = useDisclosure(false);
  const schema = useQuery({ ...experimentSchemaQuery, enabled: isOpen });
  return (
    <>
      <Button
        variant="default"
        onClick={open}
        disabled={experiment.latest_run != null && isActive(experiment.latest_run.state)}
      >
        Edit
      </Button>
      <Modal opened={isOpen} onClose={close} title="What was filmed" size="xl">
        <QueryView query={schema}>
          {(loaded) => <EditForm experiment={experiment} schema={loaded as JsonSchema} onDone={close} />}
        </QueryView>
      </Modal>
    </>
  );
}

function EditForm({
  experiment,
  schema,
  onDone,
}: {
  experiment: Experiment;
  schema: JsonSchema;
  onDone: () => void;
}) {
  const fields = useMemo(() => fieldsOf(schema), [schema]);
  const [document, setDocument] = useState<Document>(() => withoutNull(experiment.experiment));
  const cache = useQueryClient();
  const save = useMutation({
    mutationFn: async () =>
      (await experimentsUpdate({ path: { experiment_id: experiment.id }, body: { experiment: document } }))
        .data,
    onSuccess: (changed) => {
      cache.setQueryData(["experiments", experiment.id], changed);
      onDone();
    },
  });
  const problem = save.error ? toProblem(save.error) : null;
  const messages = { ...fieldMessages(problem), ...check(fields, document) };
  return (
    <Stack>
      <ExperimentForm fields={fields} document={document} onChange={setDocument} messages={messages} />
      {problem && <ProblemAlert problem={problem} shownFields={(path) => messages[path] !== undefined} />}
      <Group justify="space-between">
        <Text fz="xs" c="dimmed">
          Runs that are there keep the description they were made with.
        </Text>
        <Button
          disabled={Object.keys(check(fields, document)).length > 0}
          loading={save.isPending}
          onClick={() => save.mutate()}
        >
          Save
        </Button>
      </Group>
    </Stack>
  );
}

function withoutNull(document: Document): Document {
  return Object.fromEntries(Object.entries(document).filter(([, value]) => value !== null));
}
