import { QueryClient, QueryClientProvider, useQuery } from "@tanstack/react-query";
import { renderHook, waitFor } from "@testing-library/react";
import { createElement, type ReactNode } from "react";
import { expect, it, vi } from "vitest";
import type { Run } from "../client";
import { client } from "../client/client.gen";
import { drawingIn } from "./drawing";
import { type Figure, type RangeChange, type Ranges, rangesFromRelayout } from "./figure";
import type { Look } from "./fitting";
import { figureQuery } from "./queries";
import { useTogether } from "./together";

const figure = (high: number): Figure => ({
  data: [{ type: "heatmap", zmin: 0, zmax: high, colorbar: {} }],
  layout: { xaxis: { title: { text: "time t (s)" } }, yaxis: { title: { text: "radius r (µm)" } } },
});
const look = (ranges: Ranges): Look => ({ isDark: false, height: 400, width: 600, ranges });
const zoomOf = (time_s: [number, number]) => ({ "xaxis.range[0]": time_s[0], "xaxis.range[1]": time_s[1] });

/** A plot as it hears of zooms; Plotly tells of its own relayouts before their promise is kept, as it does here. */
function plot(told: RangeChange[] = []) {
  const hear = (event: Record<string, unknown>) => {
    if (!drawing.isByHand()) return;
    drawing.zoomed(event);
    told.push(rangesFromRelayout(event, drawing.layout()));
  };
  const react = vi.fn(async () => undefined);
  const relayout = vi.fn(async (_: HTMLElement, update: never) => hear(update));
  const drawing = drawingIn(document.createElement("div"), { react, relayout });
  return { drawing, react, relayout, hear, told };
}

it("a zoom by hand is told once and drawn once: by Plotly where it was made, as a move in the plot beside it", async () => {
  const [left, right, shown] = [plot(), plot(), figure(3)];
  for (const { drawing } of [left, right]) drawing.show(shown, look({}), {});
  left.hear(zoomOf([10, 20]));
  expect(left.told).toEqual([{ time_s: [10, 20] }]);

  const zoomed = look({ time_s: [10, 20] });
  for (const { drawing } of [left, right, left, right]) drawing.show(shown, zoomed, {});
  await Promise.resolve();
  expect([left.react.mock.calls.length, left.relayout.mock.calls.length]).toEqual([1, 0]);
  expect([right.react.mock.calls.length, right.relayout.mock.calls.length]).toEqual([1, 1]);
  expect(right.relayout.mock.calls[0]?.[1]).toEqual({ "xaxis.range": [10, 20] });
  expect(right.told).toEqual([]);

  const finer = figure(2);
  for (const { drawing } of [left, right]) drawing.show(finer, zoomed, {});
  expect([left.react.mock.calls.length, right.react.mock.calls.length]).toEqual([2, 2]);
});

it("a zoom that is taken back shows everything again, and another one is heard", async () => {
  const { drawing, relayout, react, hear, told } = plot();
  const shown = figure(3);
  drawing.show(shown, look({ time_s: [10, 20] }), {});
  drawing.show(shown, look({}), {});
  await new Promise((done) => setTimeout(done));
  expect(relayout.mock.calls.map((call) => call[1])).toEqual([{ "xaxis.autorange": true }]);
  expect(react).toHaveBeenCalledTimes(1);
  hear(zoomOf([1, 2]));
  expect(told).toEqual([{ time_s: [1, 2] }]);
});

it("one zoom asks once for each map, and both change in one draw, in common colours", async () => {
  const asked: string[] = [];
  const answers = new Map<string, (answer: Response) => void>();
  const answer = (address: string, high: number) => answers.get(address)?.(Response.json(figure(high)));
  const before = client.getConfig();
  client.setConfig({
    baseUrl: "http://127.0.0.1/",
    fetch: async (request) => {
      const { pathname, search } = new URL((request as Request).url);
      const address = `${pathname.split("_").at(-1)}${search}`;
      asked.push(address);
      return new Promise((resolve) => answers.set(address, resolve));
    },
  });
  const run = { id: "1", state: "completed", stages: STAGES } as unknown as Run;
  const queries = new QueryClient({ defaultOptions: { queries: { retry: false } } });
  const wrapper = ({ children }: { children: ReactNode }) =>
    createElement(QueryClientProvider, { client: queries }, children);
  const hook = renderHook(
    (range) => {
      const left = useQuery(figureQuery(run, "size_distribution_before", range));
      const right = useQuery(figureQuery(run, "size_distribution_after", range));
      return useTogether(left, right);
    },
    { wrapper, initialProps: {} },
  );
  try {
    await waitFor(() => expect(asked).toHaveLength(2));
    answer("before", 3);
    answer("after", 4);
    await waitFor(() => expect(hook.result.current.map((one) => one?.data[0]?.zmax)).toEqual([4, 4]));
    const whole = hook.result.current;

    hook.rerender({ from_s: 10, to_s: 20 });
    hook.rerender({ from_s: 10, to_s: 20 });
    await waitFor(() => expect(asked).toHaveLength(4));
    answer("before?from_s=10&to_s=20", 1);
    await new Promise((done) => setTimeout(done, 20));
    expect(hook.result.current[0]).toBe(whole[0]);
    answer("after?from_s=10&to_s=20", 2);
    await waitFor(() => expect(hook.result.current.map((one) => one?.data[0]?.zmax)).toEqual([2, 2]));
    expect(asked).toHaveLength(4);
  } finally {
    client.setConfig(before);
    queries.clear();
  }
});

const STAGES = ["prepare", "detect", "track", "analyse"].map((name) => ({ name, state: "completed" }));
