import { Button, Stack } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import type { Experiment } from "../client";
import { plural } from "../platform/format";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { ChosenFiles } from "../uploads/ChosenFiles";
import { DropArea } from "../uploads/DropArea";
import { SupportFiles } from "../uploads/SupportFiles";
import { baseName, type Found, NAMED_ROLES, rolesIn, sortFiles } from "../uploads/sorting";
import { itemsOf, startUpload } from "../uploads/uploads";
import { allFiles } from "./queries";

/** Choose frames for an experiment that is described already, with the files its description names. */
export function AddFrames({ experiment }: { experiment: Experiment }) {
  const [files, setFiles] = useState<Found[]>([]);
  const wanted = rolesIn(experiment.experiment);
  const roles = NAMED_ROLES.filter((role) => wanted[role] !== undefined);
  const sorted = sortFiles(files, wanted);
  const send = useMutation({
    mutationFn: async () => {
      const already = new Map(
        (await allFiles(experiment.id)).map(({ name, size_bytes }) => [name, size_bytes]),
      );
      startUpload(experiment.id, itemsOf(sorted, experiment.experiment, already));
    },
  });
  const isComplete =
    sorted.frames.length > 0 && (experiment.stack.n_files > 0 || roles.every((role) => sorted.named[role]));

  return (
    <Stack gap="sm">
      <DropArea onFound={(found) => setFiles([...files, ...found])} />
      <ChosenFiles
        frames={sorted.frames}
        left_out={sorted.left_out}
        onClear={() => setFiles(Object.values(sorted.named))}
      />
      {roles.length > 0 && (
        <SupportFiles
          roles={roles}
          wanted={wanted}
          chosen={sorted.named}
          messages={{}}
          onChoose={(role, found) =>
            setFiles([
              ...files.filter((one) => one !== sorted.named[role]),
              { ...found, name: wanted[role] ?? baseName(found.name) },
            ])
          }
        />
      )}
      {send.error && <ProblemAlert problem={toProblem(send.error)} />}
      {sorted.frames.length > 0 && (
        <Button disabled={!isComplete} loading={send.isPending} onClick={() => send.mutate()}>
          Upload {plural(sorted.frames.length, "file")}
        </Button>
      )}
    </Stack>
  );
}
