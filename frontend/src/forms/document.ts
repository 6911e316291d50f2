import type { Field } from "./schema";

/** A document as YAML or JSON gives it: mappings, lists, texts, numbers. */
export type Document = Record<string, unknown>;

export function isMapping(value: unknown): value is Document {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

export function valueAt(document: Document, path: string): unknown {
  return path
    .split(".")
    .reduce<unknown>((value, name) => (isMapping(value) ? value[name] : undefined), document);
}

/** The document with `value` at `path`; `undefined` takes the field out. */
export function withValue(document: Document, path: string, value: unknown): Document {
  const [name = "", ...rest] = path.split(".");
  if (rest.length === 0) {
    const { [name]: _, ...others } = document;
    return value === undefined ? others : { ...document, [name]: value };
  }
  const inner = isMapping(document[name]) ? (document[name] as Document) : {};
  return { ...document, [name]: withValue(inner, rest.join("."), value) };
}

/** What the schema takes where nothing is said, so that a form can show it. */
export function defaultsOf(fields: Field[]): Document {
  const document: Document = {};
  for (const { name, fallback, input } of fields) {
    if (input.kind === "group") document[name] = defaultsOf(input.fields);
    else if (!isEmpty(fallback)) document[name] = fallback;
  }
  return document;
}

function isEmpty(value: unknown): boolean {
  return value === undefined || value === "" || (Array.isArray(value) && value.length === 0);
}

/** `{a: {b: 1}}` as `{"a.b": 1}`; lists stay values. */
export function flatten(document: Document, prefix = ""): Record<string, unknown> {
  return Object.fromEntries(
    Object.entries(document).flatMap(([name, value]) => {
      const path = prefix ? `${prefix}.${name}` : name;
      return isMapping(value) ? Object.entries(flatten(value, path)) : [[path, value]];
    }),
  );
}
