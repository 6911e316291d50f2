import { Badge, Box, Group } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useRef } from "react";
import type { FigureEntry, Run } from "../client";
import { apiUrl } from "../platform/base";
import { Loading, QueryView } from "../platform/QueryView";
import { useInSight } from "../platform/sight";
import { type Asked, askedOf, askedQuery } from "./asked";
import { FigurePanel, TableLink } from "./FigurePanel";
import type { Figure, RangeChange, Ranges } from "./figure";
import { NotYet } from "./NotYet";
import { Plot } from "./Plot";
import { figureQuery } from "./queries";

type FigureCardProps = {
  run: Run;
  entry: FigureEntry;
  ranges: Ranges;
  onRanges: (change: RangeChange) => void;
  /** What is asked of it besides the shared ranges. */
  more?: Asked;
  height?: number;
} & Pick<Parameters<typeof Plot>[0], "aligned_s" | "marks" | "onMoment">;

/** One figure of the paper: how it is computed, drawn for the ranges that are looked at, its table to download. */
export function FigureCard({ run, entry, ranges, onRanges, more, height = 420, ...plot }: FigureCardProps) {
  const asked = { ...askedOf(entry, ranges), ...more };
  const place = useRef<HTMLDivElement>(null);
  const isSeen = useInSight(place);
  const query = useQuery({ ...figureQuery(run, entry.name, asked), enabled: isSeen && entry.is_available });
  return (
    <FigurePanel entry={entry} actions={<PaperAndTable run={run} entry={entry} asked={asked} />}>
      <div ref={place}>
        <QueryView query={query} loading={isSeen ? <Loading rows={1} height={height} /> : <Box h={height} />}>
          {(figure) =>
            figure ? (
              <Plot
                figure={figure as unknown as Figure}
                label={entry.title}
                height={height}
                ranges={ranges}
                onRanges={onRanges}
                {...plot}
              />
            ) : (
              <NotYet run={run} />
            )
          }
        </QueryView>
      </div>
    </FigurePanel>
  );
}

/** Where the paper has a figure, and its numbers to take away. */
export function PaperAndTable({ run, entry, asked }: { run: Run; entry: FigureEntry; asked: Asked }) {
  return (
    <Group gap="sm" wrap="nowrap">
      {entry.paper && (
        <Badge variant="default" tt="none" fw={500}>
          {entry.paper}
        </Badge>
      )}
      {entry.has_table && entry.is_available && (
        <TableLink
          title={entry.title}
          href={apiUrl(["runs", run.id, "figures", entry.name, "table.csv"], askedQuery(asked))}
          fileName={`${entry.name}-run-${run.number}.csv`}
        />
      )}
    </Group>
  );
}
