import { Text } from "@mantine/core";
import type { Experiment } from "../client";
import { flatten } from "../forms/document";
import { confirmedBy } from "../frames/confirmed";
import { type Fact, Facts } from "../platform/Facts";
import { plainField } from "../platform/fields";
import { formatBytes, formatCount, formatDuration, formatTime, plural } from "../platform/format";
import { Moment } from "../platform/Moment";
import { shown } from "../runs/differing";

/** The order in which people think of a film; the store keeps none. */
const ORDER = ["pixel_size_um", "frame_interval_s", "timestamps", "droplets", "phase", "material", "up"];

function place(path: string): number {
  const index = ORDER.indexOf(path.split(".")[0] ?? "");
  return index < 0 ? ORDER.length : index;
}

const SHOWN_ELSEWHERE = new Set(["name", "tags", "notes"]);

/** The description, field by field, with units. */
export function Description({ experiment }: { experiment: Experiment }) {
  const document = experiment.experiment;
  const facts = Object.entries(flatten(document))
    .filter(([path, value]) => !SHOWN_ELSEWHERE.has(path) && value !== null && value !== "")
    .sort(([a], [b]) => place(a) - place(b))
    .map(([path, value]): Fact => [plainField(path), shownValue(path, value)]);
  return (
    <>
      <Facts facts={facts} label="What was filmed" />
      {typeof document.notes === "string" && document.notes && (
        <Text fz="sm" style={{ whiteSpace: "pre-wrap" }}>
          {document.notes}
        </Text>
      )}
    </>
  );
}

function shownValue(path: string, value: unknown): string {
  if (path === "recorded_at") return formatTime(String(value));
  if (Array.isArray(value)) return `(${value.map((part) => shown("", part)).join(", ")})`;
  return shown(path, value);
}

export function StackFacts({ experiment }: { experiment: Experiment }) {
  const { stack } = experiment;
  const facts: Fact[] = [
    ["Files", `${formatCount(stack.n_files)}, ${formatBytes(stack.size_bytes)}`],
    ["Group", experiment.group.name],
    ["Created", <Moment key="created" time={experiment.created_at} />],
  ];
  if (stack.n_frames != null) {
    facts.unshift(
      ["Frames", formatCount(stack.n_frames)],
      ["Size", `${stack.columns} × ${stack.rows} px, ${stack.dtype}`],
      ["Duration", formatDuration(stack.duration_s)],
    );
  }
  if (stack.confirmation) facts.push(["Confirmed", confirmedBy(stack.confirmation)]);
  if (stack.broken_frames.length > 0)
    facts.push(["Left out", `${plural(stack.broken_frames.length, "frame")} that cannot be read`]);
  return <Facts facts={facts} label="Stack" />;
}
