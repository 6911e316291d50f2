import { Text, VisuallyHidden } from "@mantine/core";
import { formatNumber } from "../platform/format";
import { Prose } from "../platform/Prose";
import type { Field, Range } from "./schema";

/** The label; its unit stands at the end of the input, and in the label only for those who hear it. */
export function Label({ field }: { field: Field }) {
  return (
    <>
      {field.label}
      {field.unit && <VisuallyHidden> ({field.unit})</VisuallyHidden>}
    </>
  );
}

/** What a field means, what the paper takes for it, and what it may be. */
export function Help({ field }: { field: Field }) {
  const { paper, input } = field;
  // Bounds that only keep nonsense out would say little beside what a person measured.
  const isKnob =
    input.kind === "number" &&
    (paper || (input.range.minimum !== undefined && input.range.maximum !== undefined));
  const range = isKnob ? rangeInWords(input.range) : "";
  if (!field.help && !paper && !range) return null;
  return (
    <>
      {field.help && <Prose text={field.help} />}
      {paper && (
        <>
          {" "}
          <Text span fz="inherit" style={{ whiteSpace: "nowrap" }}>
            Paper: {typeof paper.value === "number" ? formatNumber(paper.value) : String(paper.value)}
            {field.unit && ` ${field.unit}`}
            {paper.section && ` (section ${paper.section})`}.
          </Text>
        </>
      )}
      {range && ` ${range}.`}
    </>
  );
}

/** `0.5 to 500`, `More than 0`: the bounds of a number, as far as it has any. */
export function rangeInWords(range: Range): string {
  const low = range.minimum ?? range.exclusiveMinimum;
  const high = range.maximum ?? range.exclusiveMaximum;
  const from = range.minimum === undefined ? "more than" : "at least";
  const to = range.maximum === undefined ? "less than" : "at most";
  if (low !== undefined && high !== undefined) {
    const isOpen = range.minimum === undefined || range.maximum === undefined;
    return isOpen
      ? `Range: ${from} ${formatNumber(low)}, ${to} ${formatNumber(high)}`
      : `Range: ${formatNumber(low)} to ${formatNumber(high)}`;
  }
  if (low !== undefined) return `Range: ${from} ${formatNumber(low)}`;
  return high === undefined ? "" : `Range: ${to} ${formatNumber(high)}`;
}
