import { MantineProvider } from "@mantine/core";
import { render, screen } from "@testing-library/react";
import { expect, it } from "vitest";
import { fieldsOf, type JsonSchema } from "../forms/schema";
import { ParameterForm } from "./ParameterForm";

const SCHEMA: JsonSchema = {
  type: "object",
  properties: {
    detection: {
      type: "object",
      properties: {
        method: { enum: ["paper", "fast"], type: "string", default: "paper" },
        radius_min_um: { type: "number", default: 4, unit: "um", paper_value: 4, paper_section: "3.2.1" },
        paper: {
          type: "object",
          properties: { noise: { type: "number", default: 1 }, offset: { type: "number", default: 30 } },
        },
        fast: { type: "object", properties: { speed: { type: "number", default: 1 } } },
      },
    },
  },
};

function show(document: Record<string, unknown>, messages: Record<string, string> = {}) {
  render(
    <MantineProvider>
      <ParameterForm
        fields={fieldsOf(SCHEMA)}
        document={document}
        onChange={() => undefined}
        messages={messages}
      />
    </MantineProvider>,
  );
}

it("a parameter shows its unit and the paper's value", () => {
  show({ detection: { method: "paper", radius_min_um: 5 } });
  expect(screen.getByRole("textbox", { name: /^Radius min\s*\(µm\)$/ })).toBeTruthy();
  expect(screen.getByText(/Paper: 4 µm \(section 3\.2\.1\)/)).toBeTruthy();
});

it("only the constants of the method in use are offered, with how many were changed", () => {
  show({ detection: { method: "paper", paper: { noise: 2, offset: 30 } } });
  const constants = screen.getAllByRole("button", { name: /constant/ });
  expect(constants.map((button) => button.textContent)).toEqual(["2 constants of the method1 changed"]);
});

it("constants with a message unfold by themselves", () => {
  show(
    { detection: { method: "paper", paper: { noise: "x" } } },
    { "detection.paper.noise": "Must be a number." },
  );
  expect(screen.getByRole("button", { name: /constants/ }).getAttribute("aria-expanded")).toBe("true");
  expect(screen.getByText("Must be a number.")).toBeTruthy();
});
