import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { ProblemError, UNREACHABLE } from "../platform/problem";
import { type Away, Patience } from "./patience";

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

const failure = (status: number) => new ProblemError({ ...UNREACHABLE, code: `http.${status}`, status });

/** A server that is away until it is said to be back, asked patiently. */
function away() {
  const stopping = new AbortController();
  const told: (Away | null)[] = [];
  const server = { isAway: true, n_asked: 0 };
  const patience = new Patience((now) => told.push(now), stopping.signal);
  const ask = () =>
    patience.through(async () => {
      server.n_asked += 1;
      if (server.isAway) throw new ProblemError(UNREACHABLE);
      return "here";
    });
  return { patience, server, stopping, told, ask };
}

it("asks again after growing pauses, however long it takes, and says when", async () => {
  const { server, told, ask } = away();
  const answer = ask();
  await vi.advanceTimersByTimeAsync(3600_000);
  expect(server.n_asked).toBeGreaterThan(60);
  expect(server.n_asked).toBeLessThan(70);
  const last = told.at(-1);
  expect(last?.problem.detail).toBe("The server does not answer.");
  expect(last?.until_ms).toBeGreaterThan(Date.now());
  server.isAway = false;
  await vi.advanceTimersByTimeAsync(60_000);
  expect(await answer).toBe("here");
  expect(told.at(-1)).toBeNull();
});

it.each(["online", "click"])("asks at once: %s", async (how) => {
  const { patience, server, ask } = away();
  const answer = ask();
  await vi.advanceTimersByTimeAsync(300_000);
  server.isAway = false;
  if (how === "online") window.dispatchEvent(new Event("online"));
  else patience.tryNow();
  await vi.advanceTimersByTimeAsync(0);
  expect(await answer).toBe("here");
});

it("all who wait wait together, and one pause is not made longer by another's failure", async () => {
  const { server, told, ask } = away();
  const answers = [ask(), ask(), ask()];
  await vi.advanceTimersByTimeAsync(1000);
  expect(told).toHaveLength(1);
  server.isAway = false;
  await vi.advanceTimersByTimeAsync(1000);
  expect(await Promise.all(answers)).toEqual(["here", "here", "here"]);
  expect(server.n_asked).toBe(6);
});

it("what is not the server being away is an error at once", async () => {
  const { patience, told } = away();
  for (const status of [400, 409, 415, 500, 507])
    await expect(patience.through(() => Promise.reject(failure(status)))).rejects.toMatchObject({
      problem: { status },
    });
  expect(told).toEqual([]);
});

it("who stops need not wait", async () => {
  const { stopping, ask } = away();
  const answer = expect(ask()).rejects.toMatchObject({ name: "AbortError" });
  await vi.advanceTimersByTimeAsync(100);
  stopping.abort();
  await answer;
});
