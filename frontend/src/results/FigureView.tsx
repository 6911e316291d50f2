import { Box } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useRef } from "react";
import type { FigureName, Run } from "../client";
import { Loading, QueryView } from "../platform/QueryView";
import { useInSight } from "../platform/sight";
import type { Figure, RangeChange, Ranges } from "./figure";
import { NotYet } from "./NotYet";
import { Plot } from "./Plot";
import { figureQuery } from "./queries";

type FigureViewProps = {
  run: Run;
  name: FigureName;
  label: string;
  height?: number;
  ranges?: Ranges;
  onRanges?: (changed: RangeChange) => void;
};

/** One figure of a run: loading, not there yet, failed, or drawn. */
export function FigureView({ run, name, ...plot }: FigureViewProps) {
  const place = useRef<HTMLDivElement>(null);
  const isSeen = useInSight(place);
  const query = useQuery({ ...figureQuery(run, name), enabled: isSeen });
  return (
    <div ref={place}>
      <QueryView
        query={query}
        loading={isSeen ? <Loading rows={1} height={plot.height} /> : <Box h={plot.height} />}
      >
        {(figure) =>
          figure ? <Plot figure={figure as unknown as Figure} {...plot} /> : <NotYet run={run} />
        }
      </QueryView>
    </div>
  );
}
