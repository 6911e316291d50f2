import { expect, it } from "vitest";
import { EXAMPLE } from "../forms/example";
import { fieldsOf } from "../forms/schema";
import { sortFiles } from "../uploads/sorting";
import { checkDraft } from "./draft";
import { partsOf, unknownNames } from "./fields";
import { readYaml } from "./yaml";

const fields = fieldsOf(EXAMPLE);
const NO_FILES = sortFiles([], {});
const GOOD = { name: "a", pixel_size_um: 1, droplets: "dark", material: "water", frame_interval_s: 1 };

it("a film has one source of time: an interval or timestamps", () => {
  const { frame_interval_s: _, ...timeless } = GOOD;
  expect(checkDraft(fields, GOOD, NO_FILES)).toEqual({});
  expect(Object.keys(checkDraft(fields, timeless, NO_FILES))).toEqual(["frame_interval_s"]);
  const file = { name: "t.csv", file: new File(["time_s"], "t.csv") };
  const both = { ...GOOD, timestamps: "t.csv" };
  expect(Object.keys(checkDraft(fields, both, sortFiles([file], { timestamps: "t.csv" })))).toEqual([
    "timestamps",
  ]);
});

it("a file that the description names must be there", () => {
  expect(checkDraft(fields, { ...GOOD, flat_field: "flat.tif" }, NO_FILES).flat_field).toContain("flat.tif");
});

it("what every film needs comes first, the rest under more", () => {
  const { first, more } = partsOf(fields);
  expect(first.map(({ name }) => name)).toEqual([
    "name",
    "pixel_size_um",
    "frame_interval_s",
    "droplets",
    "material",
  ]);
  expect(more.map(({ name }) => name)).toContain("notes");
});

it("experiment.yaml fills the form; fields that are not known are named, those left empty pass", async () => {
  const document = await readYaml("name: a\npixel_size_um: 0.625\nup: [0, -1]\nphase:\ncolour: red\n");
  expect(document).toEqual({ name: "a", pixel_size_um: 0.625, up: [0, -1], colour: "red" });
  expect(unknownNames(fields, document)).toEqual(["colour"]);
});

it("text that is no description is told in one sentence", async () => {
  await expect(readYaml("just words")).rejects.toThrow("This is no experiment.yaml");
  await expect(readYaml("a: [1, 2")).rejects.toThrow(/^This is not valid YAML: [^\n]*$/);
});
