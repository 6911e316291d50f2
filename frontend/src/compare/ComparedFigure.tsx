import { Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import type { ComparisonFigureEntry, ComparisonFigureName } from "../client";
import { apiUrl } from "../platform/base";
import { Loading, QueryView } from "../platform/QueryView";
import { askedOf, askedQuery } from "../results/asked";
import { FigurePanel, TableLink } from "../results/FigurePanel";
import type { Figure } from "../results/figure";
import { Plot } from "../results/Plot";
import { useComparison } from "./address";
import { comparedFigureQuery } from "./queries";

const HEIGHTS: Partial<Record<ComparisonFigureName, number>> = { moments: 640, flow_moments: 560 };

type LeftOut = { run: string; label: string; reason: string };

/** One figure of all runs; those that have nothing for it are named with the reason. */
export function ComparedFigure({ entry }: { entry: ComparisonFigureEntry }) {
  const { runs, ranges, zoom } = useComparison();
  const asked = askedOf(entry, ranges);
  const query = useQuery({ ...comparedFigureQuery(runs, entry.name, asked), enabled: entry.is_available });
  const height = HEIGHTS[entry.name] ?? 440;
  return (
    <FigurePanel
      entry={entry}
      actions={
        entry.is_available && (
          <TableLink
            title={entry.title}
            href={tableUrl(entry.name, runs, askedQuery(asked))}
            fileName={`compared-${entry.name}.csv`}
          />
        )
      }
    >
      <QueryView query={query} loading={<Loading rows={1} height={height} />}>
        {(figure) => (
          <>
            <Plot
              figure={figure as unknown as Figure}
              label={entry.title}
              height={height}
              ranges={ranges}
              onRanges={zoom}
            />
            {leftOut(figure as unknown as Figure).map(({ run, label, reason }) => (
              <Text key={run} fz="sm" c="dimmed">
                Without {label}: {reason}
              </Text>
            ))}
          </>
        )}
      </QueryView>
    </FigurePanel>
  );
}

function leftOut({ layout }: Figure): LeftOut[] {
  return (layout.meta as { left_out?: LeftOut[] } | undefined)?.left_out ?? [];
}

function tableUrl(name: string, runs: string[], asked: Record<string, string | number | undefined>): string {
  const plain = apiUrl(["compare", "figures", name, "table.csv"], asked);
  const named = runs.map((run) => `run=${encodeURIComponent(run)}`).join("&");
  return `${plain}${plain.includes("?") ? "&" : "?"}${named}`;
}
