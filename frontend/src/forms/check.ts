import { formatNumber } from "../platform/format";
import { type Document, isMapping, valueAt } from "./document";
import type { Field, Range } from "./schema";

/** Messages by field path: what can be told before the server is asked. It has the last word. */
export function check(fields: Field[], document: Document): Record<string, string> {
  const messages: Record<string, string> = {};
  for (const field of fields) checkField(field, document, messages);
  return messages;
}

function checkField(field: Field, document: Document, messages: Record<string, string>): void {
  const value = valueAt(document, field.path);
  const { input } = field;
  if (input.kind === "either") {
    const branch = input.branches[branchOf(input.branches, value)];
    if (branch && (value !== undefined || field.isRequired)) checkField(branch, document, messages);
  } else if (input.kind === "group") {
    for (const inner of input.fields) checkField(inner, document, messages);
  } else {
    const message = messageFor(field, value);
    if (message) messages[field.path] = message;
  }
}

/** Which way of giving a value is in use: a mapping is a group, anything else the first other one. */
export function branchOf(branches: Field[], value: unknown): number {
  if (value === undefined) return 0;
  const fits = (branch: Field) => (branch.input.kind === "group") === isMapping(value);
  return Math.max(0, branches.findIndex(fits));
}

function messageFor({ isRequired, input }: Field, value: unknown): string | undefined {
  if (value === undefined || value === "") return isRequired ? "Please fill in." : undefined;
  if (input.kind === "number") return numberMessage(value, input.isInteger, input.range);
  if (input.kind === "vector" && (value as unknown[]).some((part) => typeof part !== "number")) {
    return "Please give a number for each.";
  }
  if (input.kind === "choice" && !input.options.includes(String(value))) {
    return `Must be one of ${input.options.join(", ")}.`;
  }
  return undefined;
}

function numberMessage(value: unknown, isInteger: boolean, range: Range): string | undefined {
  if (typeof value !== "number" || !Number.isFinite(value)) return "Must be a number.";
  if (isInteger && !Number.isInteger(value)) return "Must be a whole number.";
  if (range.exclusiveMinimum !== undefined && value <= range.exclusiveMinimum) {
    return `Must be more than ${formatNumber(range.exclusiveMinimum)}.`;
  }
  if (range.exclusiveMaximum !== undefined && value >= range.exclusiveMaximum) {
    return `Must be less than ${formatNumber(range.exclusiveMaximum)}.`;
  }
  if (range.minimum !== undefined && value < range.minimum) {
    return `Must be at least ${formatNumber(range.minimum)}.`;
  }
  if (range.maximum !== undefined && value > range.maximum) {
    return `Must be at most ${formatNumber(range.maximum)}.`;
  }
  return undefined;
}
