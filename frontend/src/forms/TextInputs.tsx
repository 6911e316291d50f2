import { Autocomplete, Textarea, TextInput } from "@mantine/core";
import type { ReactNode } from "react";

type CommonProps = { label: ReactNode; description: ReactNode; error?: string; required: boolean };

/** A line, a line with suggestions, or several lines. */
export function WordsInput({
  input,
  value,
  onChange,
  ...common
}: CommonProps & {
  input: { isLong: boolean; suggestions: string[] };
  value: unknown;
  onChange: (value: unknown) => void;
}) {
  const text = value === undefined ? "" : String(value);
  const change = (next: string) => onChange(next === "" ? undefined : next);
  if (input.isLong) {
    return (
      <Textarea
        {...common}
        autosize
        minRows={2}
        maxRows={8}
        value={text}
        onChange={(event) => change(event.currentTarget.value)}
      />
    );
  }
  if (input.suggestions.length > 0) {
    return <Autocomplete {...common} data={input.suggestions} value={text} onChange={change} />;
  }
  return <TextInput {...common} value={text} onChange={(event) => change(event.currentTarget.value)} />;
}

/** A local date and time in, ISO 8601 with its offset out. */
export function MomentInput({
  value,
  onChange,
  ...common
}: CommonProps & { value: unknown; onChange: (value: unknown) => void }) {
  const change = (local: string) => onChange(local === "" ? undefined : new Date(local).toISOString());
  return (
    <TextInput
      {...common}
      type="datetime-local"
      value={localTime(value)}
      onChange={(event) => change(event.currentTarget.value)}
    />
  );
}

function localTime(value: unknown): string {
  const time = typeof value === "string" || value instanceof Date ? new Date(value) : undefined;
  if (!time || Number.isNaN(time.getTime())) return "";
  const shifted = new Date(time.getTime() - time.getTimezoneOffset() * 60_000);
  return shifted.toISOString().slice(0, 16);
}
