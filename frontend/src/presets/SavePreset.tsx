import { Button, Group, Stack, Text, TextInput } from "@mantine/core";
import { useState } from "react";
import type { Preset } from "../client";
import type { Document } from "../forms/document";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { named, useSavePreset } from "./queries";

type SavePresetProps = { groupId: string; presets: Preset[]; parameters: Document; isValid: boolean };

/** Keep the parameters of the form under a name. */
export function SavePreset({ groupId, presets, parameters, isValid }: SavePresetProps) {
  const [name, setName] = useState("");
  const save = useSavePreset(groupId);
  const old = named(presets, name);
  const submit = () => save.mutate({ name: name.trim(), parameters, old }, { onSuccess: () => setName("") });
  return (
    <Stack gap="xs">
      {save.error && <ProblemAlert problem={toProblem(save.error)} title="Not saved" />}
      <Group gap="xs" align="flex-end">
        <TextInput
          flex={1}
          label="Keep the parameters of the form as"
          maxLength={100}
          value={name}
          disabled={!isValid}
          onChange={(event) => {
            save.reset();
            setName(event.currentTarget.value);
          }}
          onKeyDown={(event) => {
            if (event.key !== "Enter") return;
            // The form around it would start a run.
            event.preventDefault();
            if (name.trim()) submit();
          }}
        />
        <Button onClick={submit} loading={save.isPending} disabled={!isValid || !name.trim()}>
          {old ? "Replace" : "Save"}
        </Button>
      </Group>
      <Text fz="xs" c="dimmed" role="status">
        {!isValid && "Correct the form first: what is kept must be usable."}
        {isValid && old && `Replaces ${old.name} for everybody in the group.`}
        {save.isSuccess && !name && `${save.data.name} is kept.`}
      </Text>
    </Stack>
  );
}
