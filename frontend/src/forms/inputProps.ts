import type { Field } from "./schema";

/** What every input of a form is given. */
export type FieldInputProps = {
  field: Field;
  value: unknown;
  onChange: (path: string, value: unknown) => void;
  messages: Record<string, string>;
  valueOf: (path: string) => unknown;
};
