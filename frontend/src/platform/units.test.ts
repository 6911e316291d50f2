import { expect, it } from "vitest";
import { plainField } from "./fields";
import { labelAndUnit, readableUnit } from "./units";

it.each([
  ["pixel_size_um", "Pixel size", "µm"],
  ["delta_density_kg_m3", "Density difference", "kg/m³"],
  ["sedimentation_um_s", "Sedimentation", "µm/s"],
  ["frame_interval_s", "Frame interval", "s"],
  ["n_columns", "Columns", ""],
  ["phase", "Phase", ""],
])("the name %s says its label and unit", (name, label, unit) => {
  expect(labelAndUnit(name)).toEqual({ label, unit });
});

it("units of the schemas read as people write them, and 1 is none", () => {
  expect(["um", "kg/m3", "cells", "1"].map(readableUnit)).toEqual(["µm", "kg/m³", "cells", ""]);
});

it("a dotted path of an error reads as words", () => {
  expect(plainField("material.viscosity_pa_s")).toBe("Material, viscosity");
});
