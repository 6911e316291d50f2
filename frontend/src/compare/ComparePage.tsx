import { Button, Group, Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { Comparison } from "../client";
import { Empty } from "../platform/Empty";
import { Page } from "../platform/Page";
import { Loading, QueryView } from "../platform/QueryView";
import { useComparison } from "./address";
import { ComparedFigure } from "./ComparedFigure";
import { ComparedNumbers, Differences } from "./Differences";
import { comparisonQuery } from "./queries";
import { RunChooser } from "./RunChooser";

/** Up to eight runs beside each other, of one experiment or of several. */
export function ComparePage() {
  const { runs } = useComparison();
  const query = useQuery({ ...comparisonQuery(runs), enabled: runs.length > 0 });
  return (
    <Page title="Compare">
      <Stack gap="md">
        <RunChooser comparison={runs.length > 0 ? query.data : undefined} />
        {runs.length === 0 ? (
          <Empty title="Choose runs to compare">
            Two or more, of one experiment or of several. Each keeps its colour in every figure.
          </Empty>
        ) : (
          <QueryView query={query} loading={<Loading rows={1} height={420} />}>
            {(comparison) => <Compared comparison={comparison} />}
          </QueryView>
        )}
      </Stack>
    </Page>
  );
}

function Compared({ comparison }: { comparison: Comparison }) {
  const { ranges, clear } = useComparison();
  return (
    <Stack gap="md">
      <Differences comparison={comparison} />
      {(ranges.time_s || ranges.radius_um) && (
        <Group>
          <Button size="compact-sm" variant="default" onClick={clear}>
            Of a range only: show everything
          </Button>
        </Group>
      )}
      {comparison.figures.map((entry) => (
        <ComparedFigure key={entry.name} entry={entry} />
      ))}
      <ComparedNumbers comparison={comparison} />
    </Stack>
  );
}
