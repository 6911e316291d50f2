import { queryOptions, useMutation, useQueryClient } from "@tanstack/react-query";
import {
  type TrashedThing,
  trashEmpty,
  trashLook,
  trashRemoveExperiment,
  trashRemoveFrames,
  trashRemoveRun,
  trashRestoreExperiment,
  trashRestoreFrames,
  trashRestoreRun,
} from "../client";

export const trashQuery = queryOptions({
  queryKey: ["trash"],
  queryFn: async ({ signal }) => (await trashLook({ signal })).data,
});

const RESTORE = {
  experiment: (thing: TrashedThing) =>
    trashRestoreExperiment({ path: { experiment_id: thing.experiment_id } }),
  frames: (thing: TrashedThing) => trashRestoreFrames({ path: { experiment_id: thing.experiment_id } }),
  run: (thing: TrashedThing) => trashRestoreRun({ path: { run_id: thing.run_id ?? "" } }),
};

const REMOVE = {
  experiment: (thing: TrashedThing) =>
    trashRemoveExperiment({ path: { experiment_id: thing.experiment_id } }),
  frames: (thing: TrashedThing) => trashRemoveFrames({ path: { experiment_id: thing.experiment_id } }),
  run: (thing: TrashedThing) => trashRemoveRun({ path: { run_id: thing.run_id ?? "" } }),
};

/** Whatever happens to the trash, lists and usage are others afterwards. */
function useInvalidate() {
  const cache = useQueryClient();
  return () => cache.invalidateQueries();
}

export function useRestore(thing: TrashedThing) {
  const onSuccess = useInvalidate();
  return useMutation({ mutationFn: async () => void (await RESTORE[thing.kind](thing)), onSuccess });
}

export function useRemove(thing: TrashedThing) {
  const onSuccess = useInvalidate();
  return useMutation({ mutationFn: async () => void (await REMOVE[thing.kind](thing)), onSuccess });
}

export function useEmpty() {
  const onSuccess = useInvalidate();
  return useMutation({ mutationFn: async () => (await trashEmpty()).data, onSuccess });
}
