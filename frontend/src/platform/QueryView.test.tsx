import { MantineProvider } from "@mantine/core";
import { render, screen } from "@testing-library/react";
import userEvent from "@testing-library/user-event";
import type { ComponentProps } from "react";
import { expect, it } from "vitest";
import { ProblemError, UNREACHABLE } from "./problem";
import { QueryView } from "./QueryView";

type Query = ComponentProps<typeof QueryView<string>>["query"];

function show(query: Partial<Query>) {
  const whole = {
    data: undefined,
    error: null,
    isPending: false,
    isFetching: false,
    refetch: async () => undefined,
    ...query,
  };
  render(
    <MantineProvider>
      <QueryView query={whole as Query}>{(data) => <p>{data}</p>}</QueryView>
    </MantineProvider>,
  );
}

it("says that it loads while there is nothing", () => {
  show({ isPending: true });
  expect(screen.getByRole("status", { name: "Loading" })).toBeTruthy();
});

it("tells why there is nothing, and offers to try again", async () => {
  let n_asked = 0;
  const refetch = (async () => {
    n_asked += 1;
  }) as unknown as Query["refetch"];
  show({ error: new ProblemError(UNREACHABLE), refetch });
  expect(screen.getByRole("alert").textContent).toContain("The server does not answer.");
  await userEvent.click(screen.getByRole("button", { name: "Try again" }));
  expect(n_asked).toBe(1);
});

it("keeps showing what is there when a later question fails, and says that it may be old", () => {
  show({ data: "twelve droplets", error: new ProblemError(UNREACHABLE) });
  expect(screen.getByText("twelve droplets")).toBeTruthy();
  expect(screen.getByRole("status").textContent).toContain("may be old");
});
