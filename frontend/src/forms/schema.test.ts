import { expect, it } from "vitest";
import { check } from "./check";
import { defaultsOf, flatten, valueAt, withValue } from "./document";
import { EXAMPLE } from "./example";
import { fieldsOf } from "./schema";

const fields = fieldsOf(EXAMPLE);
const named = Object.fromEntries(fields.map((field) => [field.name, field]));

const GOOD = {
  name: "a",
  pixel_size_um: 0.6,
  droplets: "bright",
  material: { delta_density_kg_m3: -30, viscosity_pa_s: 0.0014 },
};

it("a schema becomes fields in its order, each with the input that fits", () => {
  expect(fields.map(({ name, input }) => [name, input.kind])).toEqual([
    ["name", "text"],
    ["pixel_size_um", "number"],
    ["frame_interval_s", "number"],
    ["droplets", "choice"],
    ["up", "vector"],
    ["material", "either"],
    ["recorded_at", "moment"],
    ["notes", "text"],
    ["tags", "words"],
    ["flow", "group"],
  ]);
});

it("a field carries its label, unit, help and whether it must be given", () => {
  expect(named.pixel_size_um).toMatchObject({
    label: "Pixel size",
    unit: "µm",
    help: "Edge of one pixel.",
    isRequired: true,
  });
  expect(named.frame_interval_s).toMatchObject({ isRequired: false, fallback: undefined });
});

it("the help of a field is its own where it has one, else that of its type", () => {
  expect(named.droplets?.help).toBe("`bright` or `dark`.");
});

it("inner fields have dotted paths and carry the paper's value", () => {
  const inner = named.flow?.input.kind === "group" ? named.flow.input.fields : [];
  expect(inner).toMatchObject([
    { path: "flow.n_columns", unit: "cells", fallback: 25, paper: { value: 25, section: "3.2.2" } },
  ]);
});

it("a field that may be given in several ways has one branch a way", () => {
  const branches = named.material?.input.kind === "either" ? named.material.input.branches : [];
  expect(branches.map(({ label }) => label)).toEqual(["Density difference and viscosity", "By name"]);
  expect(branches[1]?.input).toMatchObject({ kind: "text", suggestions: ["water"] });
});

it("a document that is right has no messages", () => {
  expect(check(fields, { ...defaultsOf(fields), ...GOOD })).toEqual({});
});

it("what is missing is named where it is to be filled in, also inside", () => {
  expect(Object.keys(check(fields, {}))).toEqual([
    "name",
    "pixel_size_um",
    "droplets",
    "material.delta_density_kg_m3",
    "material.viscosity_pa_s",
  ]);
});

it.each([
  [{ pixel_size_um: 0 }, "pixel_size_um", "Must be more than 0."],
  [{ pixel_size_um: 20_000 }, "pixel_size_um", "Must be at most 10\u2009000."],
  [{ pixel_size_um: "abc" }, "pixel_size_um", "Must be a number."],
  [{ flow: { n_columns: 2.5 } }, "flow.n_columns", "Must be a whole number."],
  [{ flow: { n_columns: 1 } }, "flow.n_columns", "Must be at least 2."],
  [{ up: [0, undefined] }, "up", "Please give a number for each."],
  [{ droplets: "grey" }, "droplets", "Must be one of bright, dark."],
  [{ material: "" }, "material", "Please fill in."],
])("%j is told at %s", (change, path, message) => {
  expect(check(fields, { ...GOOD, ...change })).toEqual({ [path]: message });
});

it("defaults are those that the schema says, without the empty ones", () => {
  expect(defaultsOf(fields)).toEqual({ up: [0, -1], flow: { n_columns: 25 } });
});

it("values are read and written by path without changing the document they came from", () => {
  const before = { a: { b: 1 } };
  const after = withValue(withValue(before, "a.c", 2), "d.e", 3);
  expect(after).toEqual({ a: { b: 1, c: 2 }, d: { e: 3 } });
  expect(before).toEqual({ a: { b: 1 } });
  expect(valueAt(after, "a.c")).toBe(2);
  expect(valueAt(after, "a.b.c")).toBeUndefined();
  expect(withValue(after, "a.b", undefined)).toEqual({ a: { c: 2 }, d: { e: 3 } });
});

it("a nested document flattens to dotted paths, lists staying values", () => {
  expect(flatten({ a: { b: 1, c: { d: [2] } }, e: "x" })).toEqual({ "a.b": 1, "a.c.d": [2], e: "x" });
});
