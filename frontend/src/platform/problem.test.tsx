import { MantineProvider } from "@mantine/core";
import { render, screen } from "@testing-library/react";
import { expect, it } from "vitest";
import { ProblemAlert } from "./ProblemAlert";
import { fieldMessages, ProblemError, problemFromAnswer, toProblem } from "./problem";
import { isWorthRetrying } from "./queryClient";

const PROBLEM = {
  type: "about:blank",
  title: "Unprocessable",
  status: 422,
  code: "frames.truncated",
  detail: "The file ends too early.",
  errors: [{ field: "material.viscosity_pa_s", message: "must be more than 0" }],
  file: "b/f2.tif",
  frame: 7,
  hint: "Copy it again.",
};

it("a problem says what happened, where, what to do, and its code", () => {
  render(
    <MantineProvider>
      <ProblemAlert problem={PROBLEM} />
    </MantineProvider>,
  );
  const text = screen.getByRole("alert").textContent ?? "";
  for (const part of [
    "ends too early",
    "b/f2.tif",
    "frame 7",
    "Material, viscosity",
    "Copy it again.",
    "frames.truncated",
  ]) {
    expect(text).toContain(part);
  }
});

it("answers that are no problem documents become one", () => {
  expect(problemFromAnswer("<html>", 502, "Bad Gateway")).toMatchObject({ status: 502, code: "http.502" });
  expect(problemFromAnswer(PROBLEM, 422)).toBe(PROBLEM);
  expect(toProblem(new ProblemError(PROBLEM))).toBe(PROBLEM);
  expect(toProblem(new Error("x"))).toMatchObject({ code: "page.error", detail: "x" });
});

it("several messages for one field stand together", () => {
  const errors = [
    { field: "a", message: "one" },
    { field: "a", message: "two" },
  ];
  expect(fieldMessages({ ...PROBLEM, errors })).toEqual({ a: "one; two" });
});

it("the server is asked again when it was away, not when it said no", () => {
  const away = new ProblemError({ ...PROBLEM, status: 503 });
  expect([
    isWorthRetrying(0, away),
    isWorthRetrying(2, away),
    isWorthRetrying(0, new ProblemError(PROBLEM)),
  ]).toEqual([true, false, false]);
});
