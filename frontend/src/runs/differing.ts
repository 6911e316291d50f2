import { type Document, flatten } from "../forms/document";
import { plainField } from "../platform/fields";
import { formatNumber } from "../platform/format";
import { labelAndUnit } from "../platform/units";

export type Difference = { path: string; label: string; value: string };

/** For each document, only the fields in which not all are alike. */
export function differing(documents: Document[]): Difference[][] {
  const flat = documents.map((document) => flatten(document));
  const paths = [...new Set(flat.flatMap((one) => Object.keys(one)))];
  const unlike = paths.filter((path) => new Set(flat.map((one) => JSON.stringify(one[path]))).size > 1);
  return flat.map((one) =>
    unlike
      .filter((path) => one[path] !== undefined)
      .map((path) => ({ path, label: plainField(path), value: shown(path, one[path]) })),
  );
}

/** A parameter's value with its unit. */
export function shown(path: string, value: unknown): string {
  const { unit } = labelAndUnit(path.split(".").at(-1) ?? "");
  const text =
    typeof value === "number"
      ? formatNumber(value, 6)
      : typeof value === "string"
        ? value
        : typeof value === "boolean"
          ? value
            ? "Yes"
            : "No"
          : JSON.stringify(value);
  return unit ? `${text} ${unit}` : text;
}
