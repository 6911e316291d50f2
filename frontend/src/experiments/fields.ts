import type { Document } from "../forms/document";
import type { Field } from "../forms/schema";
import { NAMED_ROLES } from "../uploads/sorting";

/** What most people fill in; everything else that the schema knows stands under "More". */
const FIRST = ["name", "pixel_size_um", "frame_interval_s", "droplets", "phase", "material"];

export type FormParts = { first: Field[]; more: Field[] };

/** The schema's fields in the order of the form. Files that the description names are chosen, not typed. */
export function partsOf(fields: Field[]): FormParts {
  const typed = fields.filter(({ name }) => !NAMED_ROLES.some((role) => role === name));
  const first = FIRST.flatMap((name) => typed.filter((field) => field.name === name));
  const more = typed.filter((field) => !first.includes(field));
  return {
    first: [...first, ...more.filter(({ isRequired }) => isRequired)],
    more: more.filter(({ isRequired }) => !isRequired),
  };
}

/** Names in the document that the schema does not have. */
export function unknownNames(fields: Field[], document: Document): string[] {
  const known = new Set(fields.map(({ name }) => name));
  return Object.keys(document).filter((name) => !known.has(name));
}
