import { useQuery } from "@tanstack/react-query";
import type { FigureName, Run } from "../client";
import { QueryView } from "../platform/QueryView";
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
  const query = useQuery(figureQuery(run, name));
  return (
    <QueryView query={query}>
      {(figure) => (figure ? <Plot figure={figure as unknown as Figure} {...plot} /> : <NotYet run={run} />)}
    </QueryView>
  );
}
