import { Button, NavLink, NumberInput, Paper, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { Experiment, FigureEntry, Run } from "../client";
import { frameSource } from "../frames/source";
import { plural } from "../platform/format";
import { Loading, QueryView } from "../platform/QueryView";
import type { Asked } from "./asked";
import { FigureCard } from "./FigureCard";
import { catalogueQuery } from "./queries";
import { useSharedRanges, useView } from "./view";

const GROUPS: Record<string, string> = {
  sizes: "Sizes",
  droplets: "Droplets",
  flow: "Flow",
  time: "Over time",
  fluid: "Fluid",
  frame: "How a frame is read",
};

/** What most come for. */
const USUAL_FIGURE = "size_distribution_after";

function grouped(entries: FigureEntry[]): [string, FigureEntry[]][] {
  const groups = new Map<string, FigureEntry[]>();
  for (const entry of entries) groups.set(entry.group, [...(groups.get(entry.group) ?? []), entry]);
  return [...groups];
}

/** Every figure of the paper for this run, in the order of the catalogue. */
export function FiguresTab({ run, experiment }: { run: Run; experiment: Experiment }) {
  const catalogue = useQuery(catalogueQuery(run));
  return (
    <QueryView query={catalogue} loading={<Loading rows={1} height={420} />}>
      {(entries) => <Figures run={run} experiment={experiment} entries={entries} />}
    </QueryView>
  );
}

function Figures({ run, experiment, entries }: { run: Run; experiment: Experiment; entries: FigureEntry[] }) {
  const { search, change } = useView();
  const { ranges, zoom, clear } = useSharedRanges();
  const available = entries.filter((one) => one.is_available);
  const shown =
    entries.find(({ name }) => name === search.figure) ??
    available.find(({ name }) => name === USUAL_FIGURE) ??
    available[0];
  if (!shown) return <Text c="dimmed">There is no figure yet.</Text>;
  const needs = new Set(shown.parameters.filter((one) => one.is_required).map(({ name }) => name));
  const takesFrame = shown.parameters.some(({ name }) => name === "frame");
  const last = Math.max(0, (frameSource(experiment)?.n_frames ?? 2) - 2);
  const more: Asked = {
    ...(takesFrame && (needs.has("frame") || search.frame !== undefined)
      ? { frame: Math.min(search.frame ?? 0, last) }
      : {}),
    ...(needs.has("trajectory") ? { trajectory: search.droplet } : {}),
  };
  const lacksDroplet = needs.has("trajectory") && search.droplet === undefined;
  return (
    <div className="chooser">
      <Paper withBorder p="xs" component="nav" aria-label="Figures" className="chooser-list">
        {grouped(entries).map(([group, members]) => (
          <div key={group}>
            <Text fz="xs" fw={600} c="dimmed" px="xs" pt="xs">
              {GROUPS[group] ?? group}
            </Text>
            {members.map((entry) => (
              <NavLink
                key={entry.name}
                component="button"
                type="button"
                label={entry.title}
                description={entry.paper || undefined}
                active={entry.name === shown.name}
                aria-current={entry.name === shown.name || undefined}
                c={entry.is_available ? undefined : "dimmed"}
                onClick={() => change({ figure: entry.name })}
              />
            ))}
          </div>
        ))}
      </Paper>
      <Stack gap="sm" miw={0}>
        <Select
          className="chooser-narrow"
          aria-label="Figure"
          allowDeselect={false}
          value={shown.name}
          onChange={(name) => change({ figure: name ?? undefined })}
          data={entries.map(({ name, title }) => ({ value: name, label: title }))}
        />
        {(ranges.time_s || ranges.radius_um) && (
          <div>
            <Button size="compact-sm" variant="default" onClick={clear}>
              Of a range only: show everything
            </Button>
          </div>
        )}
        {takesFrame && (
          <NumberInput
            label="Frame"
            w={140}
            min={0}
            max={last}
            clampBehavior="strict"
            allowDecimal={false}
            allowNegative={false}
            placeholder={needs.has("frame") ? "0" : "the middle one"}
            value={search.frame ?? ""}
            onChange={(frame) => change({ frame: typeof frame === "number" ? frame : undefined })}
          />
        )}
        {lacksDroplet ? (
          <Paper withBorder p="md">
            <Text>
              This figure is of one droplet. Choose it under Droplets by a click on it, then come back:{" "}
              {shown.title}.
            </Text>
            <Button mt="sm" size="xs" variant="default" onClick={() => change({ tab: "frames" })}>
              Choose a droplet
            </Button>
          </Paper>
        ) : (
          <FigureCard
            key={shown.name}
            run={run}
            entry={shown}
            ranges={ranges}
            onRanges={zoom}
            more={more}
            height={520}
          />
        )}
        <Text fz="xs" c="dimmed">
          {plural(available.length, "figure")} of {entries.length} are there. The camera above a figure saves
          it as SVG.
        </Text>
      </Stack>
    </div>
  );
}
