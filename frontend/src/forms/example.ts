import type { JsonSchema } from "./schema";

/** A schema as pydantic writes it, with every kind of field that our documents have. For tests. */
export const EXAMPLE: JsonSchema = {
  type: "object",
  required: ["name", "pixel_size_um", "droplets", "material"],
  $defs: {
    Tone: { enum: ["bright", "dark"], type: "string", description: "How droplets look." },
    FixedMaterial: {
      type: "object",
      required: ["delta_density_kg_m3", "viscosity_pa_s"],
      properties: {
        delta_density_kg_m3: { type: "number", description: "Density." },
        viscosity_pa_s: { type: "number", exclusiveMinimum: 0 },
      },
    },
    Flow: {
      type: "object",
      properties: {
        n_columns: {
          type: "integer",
          minimum: 2,
          maximum: 1000,
          default: 25,
          unit: "cells",
          paper_value: 25,
          paper_section: "3.2.2",
        },
      },
    },
  },
  properties: {
    name: { type: "string", maxLength: 200 },
    pixel_size_um: { type: "number", exclusiveMinimum: 0, maximum: 1e4, description: "Edge of\none pixel." },
    frame_interval_s: { anyOf: [{ type: "number", exclusiveMinimum: 0 }, { type: "null" }], default: null },
    droplets: { $ref: "#/$defs/Tone", description: "`bright` or `dark`." },
    up: { type: "array", prefixItems: [{ type: "number" }, { type: "number" }], default: [0, -1] },
    material: { anyOf: [{ $ref: "#/$defs/FixedMaterial" }, { type: "string", examples: ["water"] }] },
    recorded_at: { anyOf: [{ type: "string", format: "date-time" }, { type: "null" }], default: null },
    notes: { type: "string", maxLength: 20_000, default: "" },
    tags: { type: "array", items: { type: "string" }, default: [] },
    flow: { $ref: "#/$defs/Flow", default: { n_columns: 25 }, description: "The grid." },
  },
};
