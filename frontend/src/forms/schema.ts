import { labelAndUnit, readableUnit } from "../platform/units";

/** The part of JSON Schema that pydantic writes for our documents. */
export type JsonSchema = {
  $ref?: string;
  $defs?: Record<string, JsonSchema>;
  type?: string;
  title?: string;
  /** What people read where the name does not say it. */
  label?: string;
  description?: string;
  default?: unknown;
  const?: unknown;
  enum?: unknown[];
  examples?: unknown[];
  anyOf?: JsonSchema[];
  allOf?: JsonSchema[];
  oneOf?: JsonSchema[];
  properties?: Record<string, JsonSchema>;
  required?: string[];
  items?: JsonSchema;
  prefixItems?: JsonSchema[];
  format?: string;
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
  minLength?: number;
  maxLength?: number;
  unit?: string;
  paper_value?: unknown;
  paper_section?: string;
};

export type Range = {
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
};

/** What stands for a field on a page. */
export type Input =
  | { kind: "number"; isInteger: boolean; range: Range }
  | { kind: "text"; isLong: boolean; suggestions: string[] }
  | { kind: "choice"; options: string[] }
  | { kind: "flag" }
  | { kind: "moment" }
  | { kind: "vector"; length: number }
  | { kind: "words" }
  | { kind: "group"; fields: Field[] }
  | { kind: "either"; branches: Field[] };

export type Field = {
  /** Dotted path in the document, as errors name it. */
  path: string;
  name: string;
  label: string;
  unit: string;
  help: string;
  isRequired: boolean;
  fallback: unknown;
  paper?: { value: unknown; section: string };
  input: Input;
};

const LONG_TEXT = 500;

/** The fields of a document's schema, in its order. */
export function fieldsOf(schema: JsonSchema): Field[] {
  return groupFields(schema, schema.$defs ?? {}, "");
}

type Definitions = Record<string, JsonSchema>;

function groupFields(schema: JsonSchema, definitions: Definitions, prefix: string): Field[] {
  const required = new Set(schema.required ?? []);
  return Object.entries(schema.properties ?? {}).map(([name, property]) =>
    fieldOf(name, prefix ? `${prefix}.${name}` : name, property, definitions, required.has(name)),
  );
}

function fieldOf(
  name: string,
  path: string,
  property: JsonSchema,
  definitions: Definitions,
  isRequired: boolean,
): Field {
  const resolved = resolve(property, definitions);
  const branches = branchesOf(resolved, definitions);
  const only = branches.length === 1 ? { ...branches[0], ...withoutBranches(resolved) } : resolved;
  const named = labelAndUnit(name);
  return {
    path,
    name,
    label: property.label ?? named.label,
    unit: only.unit ? readableUnit(only.unit) : named.unit,
    help: (property.description ?? only.description ?? "").replace(/\s+/g, " ").trim(),
    isRequired,
    fallback: property.default ?? undefined,
    paper:
      only.paper_value === undefined || only.paper_value === null
        ? undefined
        : { value: only.paper_value, section: only.paper_section ?? "" },
    input:
      branches.length > 1
        ? { kind: "either", branches: branches.map((branch) => branchField(branch, path, definitions)) }
        : inputOf(only, path, definitions),
  };
}

/** One way to give a field that may be given in several. */
function branchField(branch: JsonSchema, path: string, definitions: Definitions): Field {
  const input = inputOf(branch, path, definitions);
  const label = input.kind === "group" ? groupLabel(input.fields) : "By name";
  return { path, name: "", label, unit: "", help: "", isRequired: true, fallback: undefined, input };
}

function groupLabel(fields: Field[]): string {
  const names = fields.map(({ label }, index) => (index === 0 ? label : label.toLowerCase()));
  return names.length > 1 ? `${names.slice(0, -1).join(", ")} and ${names.at(-1)}` : (names[0] ?? "");
}

function inputOf(schema: JsonSchema, path: string, definitions: Definitions): Input {
  if (schema.enum) return { kind: "choice", options: schema.enum.map(String) };
  if (schema.const !== undefined) return { kind: "choice", options: [String(schema.const)] };
  switch (schema.type) {
    case "object":
      return { kind: "group", fields: groupFields(schema, definitions, path) };
    case "number":
    case "integer": {
      const { minimum, maximum, exclusiveMinimum, exclusiveMaximum } = schema;
      const range = { minimum, maximum, exclusiveMinimum, exclusiveMaximum };
      return { kind: "number", isInteger: schema.type === "integer", range };
    }
    case "boolean":
      return { kind: "flag" };
    case "array":
      return schema.prefixItems ? { kind: "vector", length: schema.prefixItems.length } : { kind: "words" };
    default:
      if (schema.format === "date-time") return { kind: "moment" };
      return {
        kind: "text",
        isLong: (schema.maxLength ?? 0) > LONG_TEXT,
        suggestions: (schema.examples ?? []).map(String),
      };
  }
}

function resolve(schema: JsonSchema, definitions: Definitions): JsonSchema {
  const only = schema.allOf?.length === 1 ? schema.allOf[0] : undefined;
  const reference = schema.$ref ?? only?.$ref;
  if (!reference) return schema;
  const { $ref: _, allOf: __, ...own } = schema;
  const target = definitions[reference.split("/").at(-1) ?? ""] ?? {};
  return { ...resolve(target, definitions), ...own };
}

/** The ways to give a value; `null` only says that it may be left out. */
function branchesOf(schema: JsonSchema, definitions: Definitions): JsonSchema[] {
  return (schema.anyOf ?? schema.oneOf ?? [])
    .map((branch) => resolve(branch, definitions))
    .filter((branch) => branch.type !== "null");
}

function withoutBranches(schema: JsonSchema): JsonSchema {
  const { anyOf: _, oneOf: __, ...rest } = schema;
  return rest;
}
