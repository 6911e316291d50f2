import { Anchor, Button, Text } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { type Experiment, framesDelete, trashRestoreFrames } from "../client";
import { ConfirmButton } from "../platform/ConfirmButton";
import { formatBytes } from "../platform/format";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";

/** Put the raw frames into the trash, and keep what was made of them. */
export function RemoveFrames({ experiment }: { experiment: Experiment }) {
  const keep = useKeep(experiment.id);
  const remove = useMutation({
    mutationFn: async () => (await framesDelete({ path: { experiment_id: experiment.id } })).data,
    onSuccess: keep,
  });
  return (
    <ConfirmButton
      size="xs"
      label="Remove the frames"
      title="Remove the raw frames?"
      action="Move to the trash"
      mutation={remove}
    >
      {formatBytes(experiment.stack.size_bytes)} go to the trash. Runs and all their results stay; pictures of
      the frames, previews and new runs need the frames back.
    </ConfirmButton>
  );
}

/** Says that the frames are gone while results stay, and where they may be. */
export function RemovedFrames({ experiment }: { experiment: Experiment }) {
  const keep = useKeep(experiment.id);
  const restore = useMutation({
    mutationFn: async () => (await trashRestoreFrames({ path: { experiment_id: experiment.id } })).data,
    onSuccess: keep,
  });
  const isThere = experiment.stack.n_files > 0;
  return (
    <Panel
      title="The raw frames were removed"
      about="Runs and their results stay. Pictures of the frames, previews and new runs need the frames."
    >
      {restore.error && <ProblemAlert problem={toProblem(restore.error)} />}
      {isThere ? (
        <>
          <Text fz="sm">
            They lie in the{" "}
            <Anchor inherit renderRoot={(props) => <Link to="/trash" {...props} />}>
              trash
            </Anchor>{" "}
            and can be brought back.
          </Text>
          <Button
            size="xs"
            variant="default"
            loading={restore.isPending}
            onClick={() => restore.mutate()}
            style={{ alignSelf: "start" }}
          >
            Bring the frames back
          </Button>
        </>
      ) : (
        <Text fz="sm" c="dimmed">
          They are gone for good.
        </Text>
      )}
    </Panel>
  );
}

function useKeep(experimentId: string) {
  const cache = useQueryClient();
  return (changed: Experiment) => {
    cache.setQueryData(["experiments", experimentId], changed);
    void cache.invalidateQueries({ queryKey: ["trash"] });
  };
}
