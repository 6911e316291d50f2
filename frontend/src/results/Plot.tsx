import { Text, useComputedColorScheme } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { useEffect, useRef, useState } from "react";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Loading } from "../platform/QueryView";
import { useInSight } from "../platform/sight";
import { type Drawing, drawingIn } from "./drawing";
import {
  captionOf,
  type Figure,
  type Mark,
  momentAt,
  type Range,
  type RangeChange,
  type Ranges,
  rangesFromRelayout,
} from "./figure";
import { soon } from "./soon";

type PlotlyModule = typeof import("./plotly").default;

type PlotProps = {
  figure: Figure;
  /** What is plotted, for those who do not see it and for the file name of an exported image. */
  label: string;
  height?: number;
  ranges?: Ranges;
  onRanges?: (changed: RangeChange) => void;
  aligned_s?: Range;
  marks?: readonly Mark[];
  /** A click at a moment, in seconds. */
  onMoment?: (time_s: number) => void;
};

/** A figure of the API, drawn by Plotly, which comes with the first of them. */
export function Plot({ figure, label, height = 420, ranges, onRanges, ...more }: PlotProps) {
  const { aligned_s, marks, onMoment } = more;
  const isDark = useComputedColorScheme("light") === "dark";
  const { ref: box, width } = useElementSize();
  const target = useRef<HTMLDivElement>(null);
  const { plotly, error } = usePlotly();
  const told = useRef({ onRanges, onMoment });
  const drawing = useRef<Drawing | null>(null);
  const isSeen = useInSight(target);
  useEffect(() => {
    told.current = { onRanges, onMoment };
  }, [onRanges, onMoment]);

  useEffect(() => {
    const element = target.current;
    if (!plotly || !element || width === 0 || !isSeen) return;
    return soon(() => {
      const isFirst = drawing.current === null;
      drawing.current ??= drawingIn(element, plotly);
      const shown = drawing.current;
      shown.show(figure, { isDark, height, width, ranges, aligned_s, marks }, configFor(label));
      if (!isFirst) return;
      listen(element, {
        plotly_relayout: (event) => {
          if (!shown.isByHand()) return;
          shown.zoomed(event);
          told.current.onRanges?.(rangesFromRelayout(event, shown.layout()));
        },
        plotly_click: ({ points }) => {
          const time_s = momentAt(points as Record<string, unknown>[], shown.layout());
          if (time_s !== null) told.current.onMoment?.(time_s);
        },
      });
    });
  }, [plotly, figure, isDark, height, width, ranges, aligned_s, marks, label, isSeen]);

  useEffect(() => {
    const element = target.current;
    return () => {
      drawing.current = null;
      if (plotly && element) plotly.purge(element);
    };
  }, [plotly]);

  if (error) return <ProblemAlert problem={toProblem(error)} title="The plot could not be drawn" />;
  const caption = captionOf(figure);
  return (
    <figure style={{ margin: 0, minWidth: 0 }} aria-label={label}>
      <div ref={box}>
        {!plotly && <Loading rows={1} height={height} />}
        <div ref={target} style={{ minHeight: plotly ? height : 0 }} />
      </div>
      {caption && (
        <Text component="figcaption" fz="xs" c="dimmed">
          {caption}
        </Text>
      )}
    </figure>
  );
}

type Handler = (event: Record<string, unknown>) => void;

/** Plotly gives an element its `on` with the first drawing, and takes all listeners with `purge`. */
function listen(element: HTMLElement, handlers: Record<string, Handler>): void {
  const { on } = element as HTMLElement & { on?: (event: string, handler: Handler) => void };
  for (const [event, handler] of Object.entries(handlers)) on?.call(element, event, handler);
}

function configFor(label: string): object {
  const filename = label.toLowerCase().replace(/[^a-z0-9]+/g, "-");
  return {
    displaylogo: false,
    showTips: false,
    // Nothing that is measured here leaves for Plotly's own service.
    showSendToCloud: false,
    modeBarButtonsToRemove: ["sendChartToCloud", "select2d", "lasso2d", "autoScale2d"],
    toImageButtonOptions: { format: "svg", filename },
  };
}

/** Kept, so that a tab's plots are drawn in the moment in which they appear. */
let loaded: PlotlyModule | null = null;

/** Plotly, once it is loaded; or why it could not be. */
function usePlotly(): { plotly: PlotlyModule | null; error: unknown } {
  const [plotly, setPlotly] = useState<PlotlyModule | null>(() => loaded);
  const [error, setError] = useState<unknown>(null);
  useEffect(() => {
    if (loaded) return;
    let isWanted = true;
    import("./plotly").then(
      (module) => {
        loaded = module.default;
        if (isWanted) setPlotly(() => module.default);
      },
      (reason: unknown) => isWanted && setError(reason),
    );
    return () => {
      isWanted = false;
    };
  }, []);
  return { plotly, error };
}
