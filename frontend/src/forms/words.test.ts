import { expect, it } from "vitest";
import { fieldsOf, type JsonSchema } from "./schema";
import { fieldAt, inWords, leavesOf } from "./words";

const SCHEMA: JsonSchema = {
  properties: {
    pixel_size_um: { type: "number" },
    phase: { anyOf: [{ enum: ["bottom", "top"] }, { type: "null" }] },
    up: {
      type: "array",
      prefixItems: [{ type: "number" }, { type: "number" }],
      label: "Up, against gravity",
    },
    is_z_time: { type: "boolean", default: false, label: "Z-planes are the frames" },
    tags: { type: "array", items: { type: "string" } },
    material: { oneOf: [{ $ref: "#/$defs/Fixed" }, { type: "string" }] },
  },
  $defs: { Fixed: { type: "object", properties: { viscosity_pa_s: { type: "number" } } } },
};
const FIELDS = fieldsOf(SCHEMA);

function said(document: Record<string, unknown>) {
  return leavesOf(FIELDS, document).map(([field, value]) => [field.label, inWords(field, value)]);
}

it("a document is said with the labels, units and words of its schema, in the order of the schema", () => {
  const document = {
    material: { viscosity_pa_s: 0.001 },
    tags: ["dense", "run 2"],
    is_z_time: true,
    up: [0, -1],
    phase: "bottom",
    pixel_size_um: 0.625,
  };
  expect(said(document)).toEqual([
    ["Pixel size", "0.625 µm"],
    ["Phase", "Bottom"],
    ["Up, against gravity", "(0, −1)"],
    ["Z-planes are the frames", "Yes"],
    ["Tags", "dense, run 2"],
    ["Viscosity", "0.001 Pa s"],
  ]);
});

it("what may be given in several ways is said in the way it was given, and what was not is left out", () => {
  expect(said({ material: "paper", phase: null, is_z_time: false })).toEqual([
    ["Z-planes are the frames", "No"],
    ["Material", "paper"],
  ]);
});

it("a field is found by its path", () => {
  expect(fieldAt(FIELDS, "material.viscosity_pa_s")?.label).toBe("Viscosity");
  expect(fieldAt(FIELDS, "is_z_time")?.label).toBe("Z-planes are the frames");
  expect(fieldAt(FIELDS, "material.colour")).toBeUndefined();
});
