import { Button, Group, Stack, Switch, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { FigureName, Run } from "../client";
import { Loading, QueryView } from "../platform/QueryView";
import { FigureCard } from "./FigureCard";
import { NotYet } from "./NotYet";
import { useTimeAxis } from "./oscillations";
import { catalogueQuery } from "./queries";
import { useSharedRanges, useView } from "./view";

/** What goes under each other on one time axis, and how high each is. */
const HEIGHTS: Partial<Record<FigureName, number>> = {
  moments: 560,
  flow_moments: 360,
  oscillations: 260,
  temperature: 240,
  driving: 260,
};

/** Numbers over time under each other: sizes, flow, oscillations, and what drives them. */
export function TimeTab({ run }: { run: Run }) {
  const { search, change } = useView();
  const { ranges, zoom, clear } = useSharedRanges();
  const catalogue = useQuery(catalogueQuery(run));
  const { aligned_s, marks, n_marks } = useTimeAxis(run, search.marks !== false);
  const plot = { ranges, onRanges: zoom, aligned_s, marks };
  return (
    <Stack gap="md">
      <Group justify="space-between" mih={30}>
        <Switch
          size="sm"
          label={n_marks === 0 ? "Mark oscillations (none stands out)" : "Mark oscillations"}
          disabled={n_marks === 0}
          checked={search.marks !== false}
          onChange={(event) => change({ marks: event.currentTarget.checked ? undefined : false })}
        />
        {ranges.time_s || ranges.radius_um ? (
          <Button size="compact-sm" variant="default" onClick={clear}>
            Show everything
          </Button>
        ) : (
          <Text fz="sm" c="dimmed">
            Draw over a part of the time axis to look at it everywhere.
          </Text>
        )}
      </Group>
      <QueryView query={catalogue} loading={<Loading rows={1} height={420} />}>
        {(entries) => {
          const shown = entries.filter(
            ({ name, reason }) => name in HEIGHTS && (!isMissing(reason) || name === "temperature"),
          );
          return shown.length === 0 ? (
            <NotYet run={run} />
          ) : (
            shown.map((entry) => (
              <FigureCard key={entry.name} run={run} entry={entry} height={HEIGHTS[entry.name]} {...plot} />
            ))
          );
        }}
      </QueryView>
    </Stack>
  );
}

/** The experiment lacks what this figure is made of: said once, for the temperature, and not again for the driving. */
function isMissing(reason: string | null): boolean {
  return /^The experiment/.test(reason ?? "");
}
