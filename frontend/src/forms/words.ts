import { formatNumber, formatTime } from "../platform/format";
import { isMapping } from "./document";
import type { Field } from "./schema";

/** `bottom_phase` as "Bottom phase". */
export function readable(option: string): string {
  const words = option.replace(/_/g, " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** A field's value as people say it. */
export function inWords({ input, unit }: Pick<Field, "input" | "unit">, value: unknown): string {
  if (typeof value === "boolean") return value ? "Yes" : "No";
  if (Array.isArray(value)) {
    const parts = value.map((part) => (typeof part === "number" ? formatNumber(part, 6) : String(part)));
    return input.kind === "vector" ? `(${parts.join(", ")})` : parts.join(", ");
  }
  if (input.kind === "moment") return formatTime(String(value));
  const text =
    typeof value === "number"
      ? formatNumber(value, 6)
      : input.kind === "choice"
        ? readable(String(value))
        : String(value);
  return unit ? `${text} ${unit}` : text;
}

/** The fields of a document that hold a value, however it was given: groups are gone into. */
export function leavesOf(fields: Field[], document: Record<string, unknown>): [Field, unknown][] {
  return fields.flatMap((field): [Field, unknown][] => {
    const value = document[field.name];
    if (value === undefined || value === null || value === "") return [];
    const inner = isMapping(value) ? groupOf(field) : undefined;
    return inner && isMapping(value) ? leavesOf(inner, value) : [[field, value]];
  });
}

/** The field at a path of names, e.g. `material.viscosity_pa_s`. */
export function fieldAt(fields: Field[], path: string): Field | undefined {
  for (const field of fields) {
    if (field.path === path) return field;
    const inner = path.startsWith(`${field.path}.`) ? groupOf(field) : undefined;
    if (inner) return fieldAt(inner, path);
  }
  return undefined;
}

function groupOf({ input }: Field): Field[] | undefined {
  if (input.kind === "group") return input.fields;
  if (input.kind !== "either") return undefined;
  return input.branches.map(groupOf).find((fields) => fields !== undefined);
}
