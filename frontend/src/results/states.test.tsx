import { MantineProvider } from "@mantine/core";
import { render, screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import { expect, it, vi } from "vitest";
import type { Run } from "../client";
import { NotYet } from "./NotYet";
import { OfAllRadii } from "./QualityTab";

it("a range of radius is said not to narrow the quality, with the way to where it does", async () => {
  const onSizes = vi.fn();
  render(
    <MantineProvider>
      <OfAllRadii radius_um={[5, 12.5]} onSizes={onSizes} />
    </MantineProvider>,
  );
  expect(screen.getByRole("status").textContent).toContain(
    "not the range of radius that you look at, 5 to 12.5 µm",
  );
  await userEvent.click(screen.getByRole("button", { name: "Show sizes" }));
  expect(onSizes).toHaveBeenCalledOnce();
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
