import { MantineProvider } from "@mantine/core";
import { render, screen } from "@testing-library/react";
import { expect, it } from "vitest";
import type { Run } from "../client";
import { HowCounted } from "./HowCounted";
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

it.each([
  [{}, {}, "An earlier version made this run"],
  [{ n_counted: 9, out_of_focus_share: 0.25 }, {}, "25 % of the droplets on trajectories are out of focus"],
  [{ n_counted: 9, out_of_focus_share: 0.25 }, {}, "but not counted here"],
  [
    { n_counted: 9, out_of_focus_share: 0.25 },
    { count_out_of_focus: true },
    "and counted as the parameters say",
  ],
])("a size distribution says which droplets it counts", (tracked, tracking, words) => {
  render(
    <MantineProvider>
      <HowCounted run={{ summary: { tracked }, parameters: { tracking } } as unknown as Run} />
    </MantineProvider>,
  );
  expect(document.body.textContent).toContain(words);
});

it("a size distribution that counts all droplets needs no words", () => {
  render(
    <MantineProvider>
      <p>nothing</p>
      <HowCounted
        run={
          { summary: { tracked: { n_counted: 9, out_of_focus_share: 0 } }, parameters: {} } as unknown as Run
        }
      />
    </MantineProvider>,
  );
  expect(screen.queryByText(/out of focus/)).toBeNull();
});
