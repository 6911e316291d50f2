import { Alert, Button, List, Progress, Stack, Text } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { type Experiment, stackComplete, stackDelete } from "../client";
import { ImportProgress } from "../imports/ImportProgress";
import { ConfirmButton } from "../platform/ConfirmButton";
import { formatBytes, formatCount, plural } from "../platform/format";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { RemovedFrames } from "../trash/RemovedFrames";
import { MissingFiles } from "../uploads/MissingFiles";
import { isRefused } from "../uploads/Upload";
import { UploadProgress } from "../uploads/UploadProgress";
import { forgetUpload, resumeUpload, stopUpload, tryNow, useUpload } from "../uploads/uploads";
import { AddFrames } from "./AddFrames";

/** How the frames get here: sending, indexing, what is wrong with them, or a place to drop them. */
export function StackPanel({ experiment }: { experiment: Experiment }) {
  const { id, stack } = experiment;
  const upload = useUpload(id);
  const cache = useQueryClient();
  const isOver = upload?.phase === "done" || upload?.phase === "stopped";

  // An upload that ended is forgotten as soon as the server's own word of it is here.
  useEffect(() => {
    if (isOver)
      void cache.refetchQueries({ queryKey: ["experiments", id], exact: true }).then(() => forgetUpload(id));
  }, [isOver, id, cache]);

  if (upload) {
    return (
      <Panel title="Upload">
        <UploadProgress
          upload={upload}
          onStop={() => stopUpload(id)}
          onTryNow={() => tryNow(id)}
          actions={
            <>
              <Button size="xs" variant="default" onClick={() => resumeUpload(id)}>
                {isRefused(upload) ? "Leave this file out and go on" : "Try again"}
              </Button>
              <StartOver experiment={experiment} />
            </>
          }
        />
      </Panel>
    );
  }
  switch (stack.state) {
    case "indexing":
      return <Indexing experiment={experiment} />;
    case "ready":
      return stack.warnings.length > 0 ? <Warnings warnings={stack.warnings} /> : null;
    case "uploading":
      return (
        <Panel
          title="Upload interrupted"
          about={`${plural(stack.n_files, "file")} (${formatBytes(stack.size_bytes)}) arrived and stay. Drop the same folder again: only what is missing is sent.`}
          actions={<StartOver experiment={experiment} />}
        >
          <MissingFiles experiment={experiment} />
          <AddFrames experiment={experiment} />
        </Panel>
      );
    case "rejected":
      return (
        <Stack gap="md">
          {stack.problem && <ProblemAlert problem={stack.problem} title="These frames cannot be used" />}
          {stack.n_files > 0 ? (
            <Panel
              title="Correct it"
              about={`The ${plural(stack.n_files, "file")} are kept. Change the description and have them read again, or drop what replaces the broken ones: only that is sent.`}
              actions={<StartOver experiment={experiment} />}
            >
              <ReadAgain experimentId={experiment.id} />
              <AddFrames experiment={experiment} />
            </Panel>
          ) : (
            <Panel title="Upload again" about="The refused files were removed.">
              <AddFrames experiment={experiment} />
            </Panel>
          )}
        </Stack>
      );
    case "expired":
      return <RemovedFrames experiment={experiment} />;
    case "empty":
      return (
        <Panel title="Add the frames">
          <AddFrames experiment={experiment} />
        </Panel>
      );
  }
}

function Indexing({ experiment }: { experiment: Experiment }) {
  const { stack } = experiment;
  if (stack.importing)
    return (
      <Panel
        title="Importing the frames"
        about="This page can be closed: the server goes on by itself. Then every frame is read once."
        actions={<StartOver experiment={experiment} />}
      >
        <ImportProgress importing={stack.importing} />
      </Panel>
    );
  const done = stack.done_frames ?? 0;
  const percent = stack.n_frames ? (100 * done) / stack.n_frames : 100;
  return (
    <Panel title="Reading the frames" about="Every frame is read once, to be sure that all can be analysed.">
      <Progress value={percent} animated={!stack.n_frames} aria-label="Frames read" />
      <Text fz="sm" c="dimmed" className="numbers">
        {stack.n_frames
          ? `${formatCount(done)} of ${plural(stack.n_frames, "frame")}`
          : `${plural(done, "frame")} so far, of ${plural(stack.n_files, "file")}`}
      </Text>
    </Panel>
  );
}

function Warnings({ warnings }: { warnings: string[] }) {
  return (
    <Alert color="orange" title="About these frames">
      <List size="sm">
        {warnings.map((warning) => (
          <List.Item key={warning}>{warning}</List.Item>
        ))}
      </List>
    </Alert>
  );
}

/** Have the files that are there read once more, as the description says now. */
function ReadAgain({ experimentId }: { experimentId: string }) {
  const cache = useQueryClient();
  const read = useMutation({
    mutationFn: async () => (await stackComplete({ path: { experiment_id: experimentId } })).data,
    onSuccess: (changed) => cache.setQueryData(["experiments", experimentId], changed),
  });
  return (
    <>
      {read.error && <ProblemAlert problem={toProblem(read.error)} />}
      <Button onClick={() => read.mutate()} loading={read.isPending} style={{ alignSelf: "start" }}>
        Read the files again
      </Button>
    </>
  );
}

/** Remove what was uploaded, to begin anew. */
function StartOver({ experiment }: { experiment: Experiment }) {
  const cache = useQueryClient();
  const remove = useMutation({
    mutationFn: async () => (await stackDelete({ path: { experiment_id: experiment.id } })).data,
    onSuccess: (changed) => {
      forgetUpload(experiment.id);
      cache.setQueryData(["experiments", experiment.id], changed);
    },
  });
  return (
    <ConfirmButton
      size="xs"
      label="Start over"
      title="Start over?"
      action="Remove the files"
      mutation={remove}
    >
      The {plural(experiment.stack.n_files, "file")} that arrived are removed; then others can be sent.
    </ConfirmButton>
  );
}
