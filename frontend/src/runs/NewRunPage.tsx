import { Anchor, Button, Group, Stack, Text } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { getRouteApi, Link, useNavigate } from "@tanstack/react-router";
import { type FormEvent, useMemo, useRef, useState } from "react";
import { type Experiment, runsCreate, stackConfirm } from "../client";
import { experimentQuery } from "../experiments/queries";
import { check } from "../forms/check";
import { type Document, defaultsOf } from "../forms/document";
import { focusFirstInvalid } from "../forms/focus";
import { fieldsOf, type JsonSchema } from "../forms/schema";
import { FirstLook } from "../frames/FirstLook";
import { Empty } from "../platform/Empty";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { fieldMessages, toProblem } from "../platform/problem";
import { Loading, QueryView } from "../platform/QueryView";
import { PresetsButton } from "../presets/PresetsButton";
import { PreviewPanel } from "../previews/PreviewPanel";
import { SuggestButton } from "../previews/SuggestButton";
import { ParameterForm } from "./ParameterForm";
import { parameterSchemaQuery, runQuery } from "./queries";

const route = getRouteApi("/experiments/$experimentId/analyse");

/** Choose parameters and start a run; `from` in the address names a run whose parameters to begin with. */
export function NewRunPage() {
  const { experimentId } = route.useParams();
  const { from } = route.useSearch();
  const experiment = useQuery(experimentQuery(experimentId));
  const schema = useQuery(parameterSchemaQuery);
  const model = useQuery({ ...runQuery(from ?? ""), enabled: from !== undefined });
  const name = String(experiment.data?.experiment.name ?? "Experiment");
  const above = [
    <Anchor key="list" inherit renderRoot={(props) => <Link to="/" {...props} />}>
      Experiments
    </Anchor>,
    <Anchor
      key="experiment"
      inherit
      renderRoot={(props) => <Link to="/experiments/$experimentId" params={{ experimentId }} {...props} />}
    >
      {name}
    </Anchor>,
  ];
  return (
    <Page title="New run" above={above}>
      {experiment.data && experiment.data.stack.state !== "ready" ? (
        <NoFrames experiment={experiment.data} />
      ) : (
        <QueryView query={schema} loading={<Loading rows={6} height={48} />}>
          {(loaded) =>
            from === undefined ? (
              <NewRun
                experimentId={experimentId}
                experiment={experiment.data}
                schema={loaded as JsonSchema}
              />
            ) : (
              <QueryView query={model}>
                {(run) => (
                  <NewRun
                    experimentId={experimentId}
                    experiment={experiment.data}
                    schema={loaded as JsonSchema}
                    begin={run.parameters}
                    origin={`Begins with the parameters of run ${run.number}.`}
                  />
                )}
              </QueryView>
            )
          }
        </QueryView>
      )}
    </Page>
  );
}

/** Nothing can be tried nor run before there are frames; where they are added, their state is told. */
function NoFrames({ experiment: { id, stack } }: { experiment: Experiment }) {
  const isReading = stack.state === "indexing";
  return (
    <Empty
      title={isReading ? "The frames are being read" : "There are no frames to analyse"}
      action={
        <Button
          mt="sm"
          renderRoot={(props) => (
            <Link to="/experiments/$experimentId" params={{ experimentId: id }} {...props} />
          )}
        >
          {isReading ? "See how far it is" : "Add frames"}
        </Button>
      }
    >
      {isReading
        ? "Parameters can be tried and a run started when that is through."
        : "Add them on the page of the experiment; then come back to try parameters and start the run."}
    </Empty>
  );
}

type NewRunProps = {
  experimentId: string;
  experiment?: Experiment;
  schema: JsonSchema;
  begin?: Document;
  origin?: string;
};

function NewRun({ experimentId, experiment, schema, begin, origin }: NewRunProps) {
  const fields = useMemo(() => fieldsOf(schema), [schema]);
  const defaults = useMemo(() => defaultsOf(fields), [fields]);
  const form = useRef<HTMLFormElement>(null);
  const [document, setDocument] = useState<Document>(begin ?? defaults);
  const isRight = experiment?.stack.confirmation != null;
  const [isAsked, setAsked] = useState(false);
  if (experiment && !isRight && !isAsked) setAsked(true);
  const confirm = useConfirm(experimentId);
  const start = useStartRun(experimentId);
  const problem = start.error ? toProblem(start.error) : null;
  const messages = { ...fieldMessages(problem), ...check(fields, document) };

  const submit = (event: FormEvent) => {
    event.preventDefault();
    if (Object.keys(check(fields, document)).length > 0) return focusFirstInvalid(form);
    start.mutate(document, { onError: () => focusFirstInvalid(form) });
  };
  const change = (next: Document) => {
    if (start.error) start.reset();
    setDocument(next);
  };

  return (
    <form ref={form} onSubmit={submit} noValidate>
      <Stack gap="md">
        <Group justify="space-between">
          <Text c="dimmed" fz="sm" maw={640}>
            {origin ?? "These values are good for a first run; the paper’s stand beside them."} Stages whose
            parameters did not change are taken from earlier runs.
          </Text>
          <Group gap="xs">
            <SuggestButton experimentId={experimentId} parameters={document} onTake={change} />
            {experiment && (
              <PresetsButton
                group={experiment.group}
                parameters={document}
                defaults={defaults}
                isValid={Object.keys(messages).length === 0}
                onTake={change}
              />
            )}
            <Button variant="default" onClick={() => change(defaults)}>
              All to defaults
            </Button>
            <Button type="submit" loading={start.isPending} disabled={!isRight}>
              Start the run
            </Button>
          </Group>
        </Group>
        {problem && <ProblemAlert problem={problem} title="The run was not started" />}
        {experiment && isAsked && (
          <Panel
            title="Is this your film?"
            about="Asked before the first run of these frames, and again where they, their times or their scale change."
          >
            <FirstLook
              experiment={experiment}
              isRefused={confirm.isError}
              onRight={() => confirm.mutate(experiment)}
            />
            {confirm.error && <ProblemAlert problem={toProblem(confirm.error)} />}
          </Panel>
        )}
        <div className="tuning">
          {experiment && (
            <div className="stays-in-sight">
              <PreviewPanel
                experiment={experiment}
                parameters={document}
                isValid={Object.keys(messages).length === 0}
              />
            </div>
          )}
          <ParameterForm fields={fields} document={document} onChange={change} messages={messages} />
        </div>
      </Stack>
    </form>
  );
}

/** Have the server keep that this person finds order, times and scale right. */
function useConfirm(experimentId: string) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: async ({ stack, experiment }: Experiment) => {
      const body = {
        checksum: stack.checksum ?? "",
        n_frames: stack.n_frames ?? 0,
        duration_s: stack.duration_s ?? 0,
        pixel_size_um: Number(experiment.pixel_size_um),
      };
      return (await stackConfirm({ path: { experiment_id: experimentId }, body })).data;
    },
    onSuccess: (changed) => cache.setQueryData(["experiments", experimentId], changed),
    onError: () => cache.invalidateQueries({ queryKey: ["experiments", experimentId], exact: true }),
  });
}

function useStartRun(experimentId: string) {
  const cache = useQueryClient();
  const navigate = useNavigate();
  return useMutation({
    mutationFn: async (parameters: Document) =>
      (await runsCreate({ path: { experiment_id: experimentId }, body: { parameters } })).data,
    onSuccess: (run) => {
      cache.setQueryData(["runs", run.id], run);
      void cache.invalidateQueries({ queryKey: ["experiments"] });
      void navigate({ to: "/runs/$runId", params: { runId: run.id } });
    },
  });
}
