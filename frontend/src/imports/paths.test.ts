import { expect, test } from "vitest";
import { below, steps } from "./paths";

test("a path is steps from the root, each with where it leads", () => {
  expect(steps("microscope", "2024/run 1")).toEqual([
    { name: "microscope", path: "" },
    { name: "2024", path: "2024" },
    { name: "run 1", path: "2024/run 1" },
  ]);
  expect(steps("microscope", "")).toEqual([{ name: "microscope", path: "" }]);
});

test("a folder lies below its path", () => {
  expect(below("", "2024")).toBe("2024");
  expect(below("2024", "run 1")).toBe("2024/run 1");
});
