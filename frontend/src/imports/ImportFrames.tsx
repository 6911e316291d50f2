import { Anchor, Breadcrumbs, Button, Group, Radio, Select, Stack, Text } from "@mantine/core";
import { IconFile, IconFolder } from "@tabler/icons-react";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { type Experiment, type ImportMode, importsCreate, type Place } from "../client";
import { formatBytes, formatCount, plural } from "../platform/format";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { below, steps } from "./paths";
import { placeQuery } from "./queries";

/** Take frames from a folder that the server can read. Nothing is shown where no such place is set up. */
export function ImportFrames({ experiment }: { experiment: Experiment }) {
  const { data } = useQuery(placeQuery(experiment.id, null, ""));
  const [isOpen, setOpen] = useState(false);
  if (!data || data.roots.length === 0) return null;
  if (!isOpen)
    return (
      <Text fz="sm" c="dimmed">
        Are they on the server already?{" "}
        <Anchor component="button" type="button" fz="sm" onClick={() => setOpen(true)}>
          Import them from there
        </Anchor>
      </Text>
    );
  return <Chooser experiment={experiment} roots={data.roots} />;
}

function Chooser({ experiment, roots }: { experiment: Experiment; roots: string[] }) {
  const [root, setRoot] = useState(roots[0] ?? "");
  const [path, setPath] = useState("");
  const [mode, setMode] = useState<ImportMode>("copy");
  const place = useQuery(placeQuery(experiment.id, root, path));
  const begin = useBegin(experiment.id);
  return (
    <Stack gap="sm" role="group" aria-label="Import from the server">
      <Group gap="sm" align="end">
        <Select
          label="Import from"
          data={roots}
          value={root}
          allowDeselect={false}
          onChange={(next) => {
            setRoot(next ?? root);
            setPath("");
          }}
        />
        <Breadcrumbs separatorMargin={4} pb={8}>
          {steps(root, path).map((step) => (
            <Anchor
              key={step.path}
              component="button"
              type="button"
              fz="sm"
              onClick={() => setPath(step.path)}
            >
              {step.name}
            </Anchor>
          ))}
        </Breadcrumbs>
      </Group>
      <QueryView query={place}>{(found) => <Content place={found} onPath={setPath} />}</QueryView>
      <Radio.Group
        label="What becomes of the files"
        value={mode}
        onChange={(next) => setMode(next as ImportMode)}
      >
        <Stack gap={4} mt={4}>
          <Radio value="copy" label="Copy them: then nothing that happens there matters" />
          <Radio
            value="reference"
            label="Leave them there: they must stay, unchanged, as long as runs need them"
          />
        </Stack>
      </Radio.Group>
      {begin.error && <ProblemAlert problem={toProblem(begin.error)} title="Nothing was imported" />}
      <Button
        onClick={() => begin.mutate({ root, path, mode })}
        loading={begin.isPending}
        disabled={!place.data || place.data.n_files === 0}
      >
        Import {place.data?.n_files ? `what is in ${steps(root, path).at(-1)?.name}` : ""}
      </Button>
    </Stack>
  );
}

function Content({ place, onPath }: { place: Place; onPath: (path: string) => void }) {
  const [first] = place.files;
  return (
    <Stack gap={2} mah={260} style={{ overflowY: "auto" }} aria-live="polite">
      {place.folders.map((name) => (
        <Anchor
          key={name}
          component="button"
          type="button"
          fz="sm"
          ta="left"
          onClick={() => onPath(below(place.path, name))}
        >
          <IconFolder size={14} aria-hidden /> {name}
        </Anchor>
      ))}
      {first && (
        <Text fz="sm">
          <IconFile size={14} aria-hidden /> {plural(place.n_files, "file")}, {formatBytes(place.size_bytes)}
          {place.n_files > 1 && ` (${first.name} and ${formatCount(place.n_files - 1)} more)`}
          {place.n_files === 1 && ` (${first.name})`}
        </Text>
      )}
      {place.folders.length === 0 && !first && (
        <Text fz="sm" c="dimmed">
          Nothing is in this folder.
        </Text>
      )}
    </Stack>
  );
}

function useBegin(experimentId: string) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: async (body: { root: string; path: string; mode: ImportMode }) =>
      (await importsCreate({ path: { experiment_id: experimentId }, body })).data,
    onSuccess: (experiment) => cache.setQueryData(["experiments", experimentId], experiment),
  });
}
