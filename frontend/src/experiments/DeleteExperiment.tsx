import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { type Experiment, experimentsDelete } from "../client";
import { ConfirmButton } from "../platform/ConfirmButton";
import { plural } from "../platform/format";
import { forgetUpload } from "../uploads/uploads";

export function DeleteExperiment({ experiment }: { experiment: Experiment }) {
  const cache = useQueryClient();
  const navigate = useNavigate();
  const remove = useMutation({
    mutationFn: () => experimentsDelete({ path: { experiment_id: experiment.id } }),
    onSuccess: async () => {
      forgetUpload(experiment.id);
      await navigate({ to: "/" });
      cache.removeQueries({ queryKey: ["experiments", experiment.id] });
      void cache.invalidateQueries({ queryKey: ["experiments"], exact: true });
      void cache.invalidateQueries({ queryKey: ["trash"] });
    },
  });
  return (
    <ConfirmButton
      label="Delete"
      title="Delete this experiment?"
      action="Delete the experiment"
      mutation={remove}
    >
      Its frames, {plural(experiment.n_runs, "run")} and all results go to the trash, where they take room
      until it is emptied, and can be brought back as long.
    </ConfirmButton>
  );
}
