import { Button, Stack } from "@mantine/core";
import { useState } from "react";
import type { Experiment } from "../client";
import { ImportFrames } from "../imports/ImportFrames";
import { plural } from "../platform/format";
import { ChosenFiles } from "../uploads/ChosenFiles";
import { DropArea } from "../uploads/DropArea";
import { SupportFiles } from "../uploads/SupportFiles";
import { baseName, type Found, NAMED_ROLES, rolesIn, sortFiles } from "../uploads/sorting";
import { itemsOf, startUpload } from "../uploads/uploads";

/** Choose frames for an experiment that is described already, with the files its description names. */
export function AddFrames({ experiment }: { experiment: Experiment }) {
  const [files, setFiles] = useState<Found[]>([]);
  const wanted = rolesIn(experiment.experiment);
  const roles = NAMED_ROLES.filter((role) => wanted[role] !== undefined);
  const sorted = sortFiles(files, wanted);
  const isComplete =
    sorted.frames.length > 0 && (experiment.stack.n_files > 0 || roles.every((role) => sorted.named[role]));

  return (
    <Stack gap="sm">
      <DropArea onFound={(found) => setFiles([...files, ...found])} />
      {files.length === 0 && <ImportFrames experiment={experiment} />}
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
      {sorted.frames.length > 0 && (
        <Button
          disabled={!isComplete}
          onClick={() => startUpload(experiment.id, itemsOf(sorted, experiment.experiment))}
        >
          Upload {plural(sorted.frames.length, "file")}
        </Button>
      )}
    </Stack>
  );
}
