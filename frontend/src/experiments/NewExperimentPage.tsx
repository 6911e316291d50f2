import { Alert, Anchor, Button, Grid, Stack, Text } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { type FormEvent, useMemo, useRef, useState } from "react";
import { experimentsCreate } from "../client";
import { focusFirstInvalid } from "../forms/focus";
import { type Field, fieldsOf, type JsonSchema } from "../forms/schema";
import { GroupChoice } from "../groups/GroupChoice";
import { plural } from "../platform/format";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { fieldMessages, toProblem } from "../platform/problem";
import { Loading, QueryView } from "../platform/QueryView";
import { ChosenFiles } from "../uploads/ChosenFiles";
import { DropArea } from "../uploads/DropArea";
import { SupportFiles } from "../uploads/SupportFiles";
import { rolesIn } from "../uploads/sorting";
import { itemsOf, startUpload } from "../uploads/uploads";
import { checkDraft, useDraft } from "./draft";
import { ExperimentForm } from "./ExperimentForm";
import { PasteYaml } from "./PasteYaml";
import { experimentSchemaQuery } from "./queries";

export function NewExperimentPage() {
  const query = useQuery(experimentSchemaQuery);
  const above = [
    <Anchor key="list" inherit renderRoot={(props) => <Link to="/" {...props} />}>
      Experiments
    </Anchor>,
  ];
  return (
    <Page title="New experiment" above={above}>
      <QueryView query={query} loading={<Loading rows={6} height={48} />}>
        {(schema) => <NewExperiment schema={schema as JsonSchema} />}
      </QueryView>
    </Page>
  );
}

function NewExperiment({ schema }: { schema: JsonSchema }) {
  const fields = useMemo(() => fieldsOf(schema), [schema]);
  const form = useRef<HTMLFormElement>(null);
  const draft = useDraft(fields);
  const { document, sorted } = draft;
  const [groupId, setGroupId] = useState<string | null>(null);
  const [isChecked, setChecked] = useState(false);
  const create = useCreate();
  const problem = create.error ? toProblem(create.error) : null;
  const messages = { ...fieldMessages(problem), ...(isChecked ? checkDraft(fields, document, sorted) : {}) };

  const submit = (event: FormEvent) => {
    event.preventDefault();
    setChecked(true);
    if (Object.keys(checkDraft(fields, document, sorted)).length > 0) return focusFirstInvalid(form);
    create.mutate(
      { document, groupId, items: itemsOf(sorted, document) },
      { onError: () => focusFirstInvalid(form) },
    );
  };
  const change = (next: typeof document) => {
    if (create.error) create.reset();
    draft.setDocument(next);
  };

  return (
    <form ref={form} onSubmit={submit} noValidate>
      <Grid gap="md">
        <Grid.Col span={{ base: 12, md: 7 }}>
          <Panel title="What was filmed" actions={<PasteYaml onDocument={draft.describe} />}>
            {draft.notice && (
              <Alert color="cyan" p="xs" role="status">
                {draft.notice}
              </Alert>
            )}
            <GroupChoice value={groupId} onChange={setGroupId} />
            <ExperimentForm fields={fields} document={document} onChange={change} messages={messages} />
          </Panel>
        </Grid.Col>
        <Grid.Col span={{ base: 12, md: 5 }}>
          <Stack gap="md">
            <Panel title="Frames">
              <DropArea onFound={draft.addFiles} hint="An experiment.yaml among them fills the form." />
              <ChosenFiles frames={sorted.frames} left_out={sorted.left_out} onClear={draft.clearFrames} />
            </Panel>
            <Panel title="Files beside the frames" about="All of these are optional.">
              <SupportFiles
                wanted={rolesIn(document)}
                chosen={sorted.named}
                onChoose={draft.chooseNamed}
                onRemove={draft.removeNamed}
                messages={messages}
              />
            </Panel>
            {problem && <ProblemAlert problem={problem} shownFields={(path) => isShown(fields, path)} />}
            <Stack gap={4}>
              <Button type="submit" size="md" loading={create.isPending}>
                {sorted.frames.length > 0 ? "Create and upload" : "Create without frames"}
              </Button>
              <Text fz="xs" c="dimmed" ta="center">
                {sorted.frames.length > 0
                  ? `${plural(itemsOf(sorted, document).length, "file")} will be sent.`
                  : "Frames can be added on the experiment’s page."}
              </Text>
            </Stack>
          </Stack>
        </Grid.Col>
      </Grid>
    </form>
  );
}

/** Whether the form has a place for a field's message. */
function isShown(fields: Field[], path: string): boolean {
  return fields.some((field) => path === field.path || path.startsWith(`${field.path}.`));
}

type Creation = {
  document: Record<string, unknown>;
  groupId: string | null;
  items: ReturnType<typeof itemsOf>;
};

function useCreate() {
  const cache = useQueryClient();
  const navigate = useNavigate();
  return useMutation({
    mutationFn: async ({ document, groupId }: Creation) =>
      (await experimentsCreate({ body: { experiment: document, group_id: groupId } })).data,
    onSuccess: (experiment, { items }) => {
      cache.setQueryData(["experiments", experiment.id], experiment);
      void cache.invalidateQueries({ queryKey: ["experiments"], exact: true });
      if (items.length > 0) startUpload(experiment.id, items);
      void navigate({ to: "/experiments/$experimentId", params: { experimentId: experiment.id } });
    },
  });
}
