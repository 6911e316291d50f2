import { Anchor, Group, Text } from "@mantine/core";
import { IconTableDown } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import type { ComparisonFigureEntry, ComparisonFigureName } from "../client";
import { apiUrl } from "../platform/base";
import { Panel } from "../platform/Panel";
import { Prose } from "../platform/Prose";
import { Loading, QueryView } from "../platform/QueryView";
import { askedOf, askedQuery } from "../results/asked";
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
    <Panel
      title={entry.title}
      about={<Prose text={entry.how} />}
      actions={
        entry.is_available && (
          <Anchor
            fz="sm"
            href={tableUrl(entry.name, runs, askedQuery(asked))}
            download={`compared-${entry.name}.csv`}
          >
            <Group gap={4} wrap="nowrap">
              <IconTableDown size={16} aria-hidden />
              Table
            </Group>
          </Anchor>
        )
      }
    >
      {entry.is_available ? (
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
      ) : (
        <Text fz="sm" c="dimmed">
          {entry.reason}
        </Text>
      )}
    </Panel>
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
