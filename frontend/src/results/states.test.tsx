import { MantineProvider } from "@mantine/core";
import { render, screen } from "@testing-library/react";
import { expect, it } from "vitest";
import type { Run } from "../client";
import { NotYet } from "./NotYet";
import { OfAllRadii } from "./QualityTab";

it("a run that was counted over all radii says so, and what to do", () => {
  render(
    <MantineProvider>
      <OfAllRadii radius_um={[5, 12.5]} />
    </MantineProvider>,
  );
  const words = screen.getByRole("status").textContent;
  expect(words).toContain("You look at 5 to 12.5 µm");
  expect(words).toContain("A new run of the experiment counts it by radius");
});

it.each([
  ["running", "It appears here as soon as the run has come to it."],
  ["failed", "What went wrong stands at the top of this page;"],
  ["cancelled", "The run was cancelled before it came to this."],
  ["completed", "A new run of the experiment"],
] as const)("of a run that is %s it says what to do", (state, words) => {
  render(
    <MantineProvider>
      <NotYet run={{ state } as Run} />
    </MantineProvider>,
  );
  expect(document.body.textContent).toContain(words);
});
