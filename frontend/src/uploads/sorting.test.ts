import { expect, it } from "vitest";
import { endsOf } from "./ChosenFiles";
import { type Found, rolesIn, sortFiles } from "./sorting";
import { itemsOf } from "./uploads";

function found(...names: string[]): Found[] {
  return names.map((name) => ({ name, file: new File(["x"], name.split("/").at(-1) ?? name) }));
}

function names(list: Found[]): string[] {
  return list.map(({ name }) => name);
}

it("a folder made by the simulator falls into frames, the files its description names, and the rest", () => {
  const sorted = sortFiles(
    found(
      "sim/frames/f1.tif",
      "sim/frames/f2.tif",
      "sim/flat_field.tif",
      "sim/experiment.yaml",
      "sim/truth.parquet",
    ),
    { flat_field: "flat_field.tif" },
  );
  expect(names(sorted.frames)).toEqual(["sim/frames/f1.tif", "sim/frames/f2.tif"]);
  expect(sorted.named.flat_field?.name).toBe("sim/flat_field.tif");
  expect(sorted.description?.name).toBe("sim/experiment.yaml");
  expect(sorted.left_out).toEqual(["sim/truth.parquet"]);
});

it("a flat field without a description is known by its name, and is no frame", () => {
  const sorted = sortFiles(found("a/flat-field.tif", "a/f1.tif"), {});
  expect(sorted.named.flat_field?.name).toBe("a/flat-field.tif");
  expect(names(sorted.frames)).toEqual(["a/f1.tif"]);
});

it("a flat field that the description beside it does not name is left out, never a frame", () => {
  const sorted = sortFiles(found("a/flat_field.tif", "a/f1.tif", "a/experiment.yaml"), {});
  expect(sorted.named).toEqual({});
  expect(sorted.left_out).toEqual(["a/flat_field.tif"]);
});

it("what systems leave in folders is passed over", () => {
  const sorted = sortFiles(
    found("a/.DS_Store", "__MACOSX/a/f1.tif", "a/Thumbs.db", "a/._f1.tif", "a/f1.PNG"),
    {},
  );
  expect(names(sorted.frames)).toEqual(["a/f1.PNG"]);
  expect(sorted.left_out).toEqual([]);
});

it("every kind of film that the service reads counts as frames", () => {
  const films = ["a.bmp", "a.avi", "a.MP4", "a.mkv", "a.h5", "a.nd2", "a.zip", "a.ome.tiff"];
  expect(names(sortFiles(found(...films, "a.exe"), {}).frames)).toEqual(films);
});

it("files go under the names that the description gives, before the frames", () => {
  const document = { flat_field: "calibration/flat.tif" };
  const sorted = sortFiles(found("x/flat.tif", "x/f1.tif", "x/f2.tif"), rolesIn(document));
  const items = itemsOf(sorted, document);
  expect(items.map(({ name, role }) => [name, role])).toEqual([
    ["calibration/flat.tif", "flat_field"],
    ["x/f1.tif", "frames"],
    ["x/f2.tif", "frames"],
  ]);
});

it("the ends of a list of names are those that people would count first and last", () => {
  expect(endsOf(["f10.tif", "f9.tif", "f2.tif"])).toEqual(["f2.tif", "f10.tif"]);
});
