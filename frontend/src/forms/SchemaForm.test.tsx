import { MantineProvider } from "@mantine/core";
import { render, screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { useState } from "react";
import { expect, it } from "vitest";
import type { Document } from "./document";
import { EXAMPLE } from "./example";
import { parseNumber } from "./NumberField";
import { SchemaForm } from "./SchemaForm";
import { fieldsOf } from "./schema";

const fields = fieldsOf(EXAMPLE);

type Seen = { document: Document };

function Holder({ seen, messages }: { seen: Seen; messages: Record<string, string> }) {
  const [document, setDocument] = useState(seen.document);
  seen.document = document;
  return <SchemaForm fields={fields} document={document} onChange={setDocument} messages={messages} />;
}

function show(begin: Document, messages: Record<string, string> = {}): Seen {
  const seen = { document: begin };
  render(
    <MantineProvider>
      <Holder seen={seen} messages={messages} />
    </MantineProvider>,
  );
  return seen;
}

it("a message stands beside its field, and the field says that it is wrong", () => {
  show({}, { pixel_size_um: "Must be more than 0." });
  const input = screen.getByRole("textbox", { name: /Pixel size/ });
  expect(input.getAttribute("aria-invalid")).toBe("true");
  const described = (input.getAttribute("aria-describedby") ?? "")
    .split(" ")
    .map((id) => document.getElementById(id));
  expect(described.map((element) => element?.textContent).join(" ")).toContain("Must be more than 0.");
});

it("numbers are typed as people write them, and what is none stays to be corrected", async () => {
  const seen = show({});
  const input = screen.getByRole("textbox", { name: /Pixel size/ });
  await userEvent.type(input, "6.25e-1");
  expect(seen.document.pixel_size_um).toBe(0.625);
  expect((input as HTMLInputElement).value).toBe("6.25e-1");
  await userEvent.clear(input);
  expect(seen.document).not.toHaveProperty("pixel_size_um");
  await userEvent.type(input, "abc");
  expect(seen.document.pixel_size_um).toBe("abc");
});

it("a field that may be given in two ways offers both", async () => {
  const seen = show({});
  await userEvent.type(screen.getByRole("textbox", { name: /Viscosity/ }), "0.001");
  expect(seen.document.material).toEqual({ viscosity_pa_s: 0.001 });
  await userEvent.click(screen.getByRole("radio", { name: "By name" }));
  await userEvent.type(screen.getByRole("combobox", { name: /Material name/ }), "water");
  expect(seen.document.material).toBe("water");
});

it("a value from elsewhere takes the place of what was typed", async () => {
  show({ pixel_size_um: 0.5, up: [0, -1] });
  expect(screen.getByRole<HTMLInputElement>("textbox", { name: /Pixel size/ }).value).toBe("0.5");
  expect(screen.getByRole<HTMLInputElement>("textbox", { name: "Up, y" }).value).toBe("-1");
});

it.each([
  ["1,5", 1.5],
  [" 12 ", 12],
  ["−3", -3],
  ["", undefined],
  ["1.4e-3", 0.0014],
  ["1e999", "1e999"],
])("the text %j means %j", (text, value) => {
  expect(parseNumber(text)).toBe(value);
});
