import { Text } from "@mantine/core";
import { formatNumber } from "../platform/format";

export type Series = { name: string; colour: string; values: readonly (number | null)[]; isDashed?: boolean };

type TraceProps = {
  title: string;
  unit?: string;
  x: readonly number[];
  series: Series[];
  /** Where a line across says "here". */
  at?: number;
  height?: number;
  onPick?: (index: number) => void;
};

const LEFT = 46;
const BOTTOM = 18;
const TOP = 8;
const WIDTH = 320;

/** A small plot of a few lines over time: what one droplet does. Light enough to stand beside a frame. */
export function Trace({ title, unit, x, series, at, height = 110, onPick }: TraceProps) {
  const all = series.flatMap(({ values }) => values.filter((value): value is number => value !== null));
  const [low, high] = paddedRange(all);
  const [first, last] = [x[0] ?? 0, x.at(-1) ?? 1];
  const toX = (value: number) => LEFT + ((value - first) / (last - first || 1)) * (WIDTH - LEFT - 6);
  const toY = (value: number) => TOP + (1 - (value - low) / (high - low)) * (height - TOP - BOTTOM);
  const pick = (event: React.MouseEvent<SVGSVGElement>) => {
    const box = event.currentTarget.getBoundingClientRect();
    const seen = ((event.clientX - box.left) / box.width) * WIDTH;
    const distances = x.map((value) => Math.abs(toX(value) - seen));
    onPick?.(distances.indexOf(Math.min(...distances)));
  };
  return (
    <figure style={{ margin: 0 }}>
      <Text component="figcaption" fz="xs" fw={500}>
        {unit ? `${title} (${unit})` : title}
        {series.length > 1 &&
          series.map(({ name, colour, isDashed }) => <Key key={name} {...{ name, colour, isDashed }} />)}
      </Text>
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: the player's keys reach the same frames */}
      <svg
        viewBox={`0 0 ${WIDTH} ${height}`}
        width="100%"
        role="img"
        aria-label={`${title} over time, from ${formatNumber(low)} to ${formatNumber(high)}${unit ? ` ${unit}` : ""}`}
        onClick={onPick && pick}
        style={{ cursor: onPick ? "pointer" : undefined, display: "block" }}
      >
        <path
          d={`M${LEFT} ${TOP}V${height - BOTTOM}H${WIDTH - 4}`}
          fill="none"
          stroke="var(--dropflow-axis)"
        />
        {[low, high].map((value) => (
          <text key={value} x={LEFT - 5} y={toY(value) + 4} textAnchor="end" className="trace-text">
            {formatNumber(value, 3)}
          </text>
        ))}
        <text x={LEFT} y={height - 4} className="trace-text">
          {formatNumber(first, 3)} s
        </text>
        <text x={WIDTH - 4} y={height - 4} textAnchor="end" className="trace-text">
          {formatNumber(last, 3)} s
        </text>
        {at !== undefined && at >= first && at <= last && (
          <path
            d={`M${toX(at)} ${TOP}V${height - BOTTOM}`}
            stroke="var(--dropflow-axis)"
            strokeDasharray="3 3"
          />
        )}
        {series.map(({ name, colour, values, isDashed }) => (
          <path
            key={name}
            d={lineOf(values, x, toX, toY)}
            fill="none"
            stroke={colour}
            strokeWidth={1.8}
            strokeDasharray={isDashed ? "4 3" : undefined}
            strokeLinejoin="round"
          />
        ))}
      </svg>
    </figure>
  );
}

function Key({ name, colour, isDashed }: { name: string; colour: string; isDashed?: boolean }) {
  return (
    <Text span fz="xs" c="dimmed" ml="xs" style={{ whiteSpace: "nowrap" }}>
      <svg width="16" height="8" aria-hidden="true" style={{ marginRight: 3 }}>
        <path d="M1 4H15" stroke={colour} strokeWidth="2" strokeDasharray={isDashed ? "4 3" : undefined} />
      </svg>
      {name}
    </Text>
  );
}

function paddedRange(values: number[]): [number, number] {
  if (values.length === 0) return [0, 1];
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const room = (high - low) * 0.05 || Math.abs(high) * 0.05 || 1;
  return [low - room, high + room];
}

/** A line that breaks where there is no value. */
export function lineOf(
  values: readonly (number | null)[],
  x: readonly number[],
  toX: (value: number) => number,
  toY: (value: number) => number,
): string {
  let isDrawing = false;
  return values
    .map((value, index) => {
      if (value === null) {
        isDrawing = false;
        return "";
      }
      const step = `${isDrawing ? "L" : "M"}${toX(x[index] ?? 0).toFixed(1)} ${toY(value).toFixed(1)}`;
      isDrawing = true;
      return step;
    })
    .join("");
}
