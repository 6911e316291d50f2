import { Text, useComputedColorScheme } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { useEffect, useRef, useState } from "react";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Loading } from "../platform/QueryView";
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
  useEffect(() => {
    told.current = { onRanges, onMoment };
  }, [onRanges, onMoment]);

  useEffect(() => {
    if (!plotly || !target.current || width === 0) return;
    drawing.current ??= drawingIn(target.current, plotly);
    drawing.current.show(figure, { isDark, height, width, ranges, aligned_s, marks }, configFor(label));
  }, [plotly, figure, isDark, height, width, ranges, aligned_s, marks, label]);

  useEffect(() => {
    const element = target.current as PlotlyElement | null;
    if (!plotly || !element || width === 0) return;
    const hearZoom = (event: Record<string, unknown>) => {
      const shown = drawing.current;
      if (!shown?.isByHand()) return;
      shown.zoomed(event);
      told.current.onRanges?.(rangesFromRelayout(event, shown.layout()));
    };
    const hearClick = ({ points }: Record<string, unknown>) => {
      const time_s = momentAt(points as Record<string, unknown>[], drawing.current?.layout() ?? {});
      if (time_s !== null) told.current.onMoment?.(time_s);
    };
    element.on?.("plotly_relayout", hearZoom);
    element.on?.("plotly_click", hearClick);
    return () => {
      element.removeListener?.("plotly_relayout", hearZoom);
      element.removeListener?.("plotly_click", hearClick);
    };
  }, [plotly, width]);

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

type PlotlyElement = HTMLDivElement & {
  on?: (event: string, handler: (event: Record<string, unknown>) => void) => void;
  removeListener?: (event: string, handler: (event: Record<string, unknown>) => void) => void;
};

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
