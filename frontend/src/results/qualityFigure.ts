import type { Quality } from "../client";
import type { Figure } from "./figure";

type Field = Exclude<keyof Quality, "first_frame" | "time_s" | "is_of_radii" | "trajectories">;
type Line = { name: string; field: Field; colour: string };

export type QualityPlot = {
  title: string;
  about: string;
  axis: string;
  factor?: number;
  series: Line[];
  right?: Line & { axis: string; factor: number };
};

/** Minutes and hours where seconds would have too many digits, as in the other figures. */
function timeUnit(longest_s: number): [number, string] {
  if (longest_s <= 600) return [1, "s"];
  return longest_s <= 4 * 3600 ? [60, "min"] : [3600, "h"];
}

/** Lines over time, as Plotly draws them. */
export function qualityFigure({ axis, factor = 1, series, right }: QualityPlot, quality: Quality): Figure {
  const [unit_s, unit] = timeUnit(Math.max(0, ...quality.time_s.slice(-1)));
  const x = quality.time_s.map((time) => time / unit_s);
  const line = ({ name, field, colour }: Line, scale: number, yaxis = "y") => ({
    type: "scatter",
    // A line needs two points.
    mode: x.length > 2 ? "lines" : "lines+markers",
    name,
    x,
    y: quality[field].map((value) => (value === null ? null : value * scale)),
    line: { color: colour, width: 1.5, dash: yaxis === "y" ? "solid" : "dot" },
    yaxis,
  });
  const look = {
    showline: true,
    mirror: right === undefined,
    ticks: "inside",
    showgrid: false,
    zeroline: false,
  };
  return {
    data: [...series.map((one) => line(one, factor)), ...(right ? [line(right, right.factor, "y2")] : [])],
    layout: {
      showlegend: series.length > 1 || right !== undefined,
      legend: { orientation: "h", y: 1, yanchor: "bottom", x: 1, xanchor: "right" },
      xaxis: { ...look, title: { text: `time t (${unit})` } },
      yaxis: { ...look, title: { text: axis }, rangemode: "tozero" },
      ...(right
        ? {
            yaxis2: {
              ...look,
              title: { text: right.axis },
              overlaying: "y",
              side: "right",
              rangemode: "tozero",
            },
          }
        : {}),
      margin: { r: right ? 60 : 16 },
    },
  };
}
