import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { afterEach, beforeEach, expect, it } from "vitest";
import { type Item, isRefused, Upload } from "./Upload";

/** A server that takes files, and answers as `answers` says for their names. */
let server: Server;
let url: string;
let arrived: Map<string, number>;
let answers: Map<string, number[]>;
let n_at_once: number;
let most_at_once: number;

beforeEach(async () => {
  [arrived, answers, n_at_once, most_at_once] = [new Map(), new Map(), 0, 0];
  server = createServer(async (request, response) => {
    response.setHeader("Access-Control-Allow-Origin", "*");
    response.setHeader("Access-Control-Allow-Methods", "PUT");
    response.setHeader("Access-Control-Allow-Headers", "content-type");
    if (request.method === "OPTIONS") return void response.end();
    most_at_once = Math.max(most_at_once, ++n_at_once);
    let size = 0;
    for await (const chunk of request) size += (chunk as Buffer).length;
    await new Promise((resolve) => setTimeout(resolve, 5));
    n_at_once -= 1;
    const name = new URL(request.url ?? "", url).searchParams.get("name") ?? "";
    const status = answers.get(name)?.shift() ?? 201;
    if (status === 201) arrived.set(name, size);
    response.statusCode = status;
    response.end(
      JSON.stringify({ code: "frames.not_an_image", detail: "This is no image.", status, title: "No" }),
    );
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  url = `http://127.0.0.1:${(server.address() as AddressInfo).port}/`;
});

afterEach(() => new Promise((resolve) => server.close(resolve)));

function item(name: string, size = 1000): Item {
  return { name, file: new File([new Uint8Array(size)], name), role: "frames" };
}

function upload(items: Item[], close: () => Promise<unknown> = async () => undefined): Upload {
  return new Upload(items, { urlOf: ({ name }) => `${url}?name=${encodeURIComponent(name)}`, close }, 10);
}

it("every file arrives whole, a few at a time, and then the server is told", async () => {
  let told = 0;
  const one = upload(
    Array.from({ length: 20 }, (_, index) => item(`f ${index}.tif`, 100 + index)),
    async () => {
      told = arrived.size;
    },
  );
  await one.run();
  expect(one.state).toMatchObject({ phase: "done", n_sent: 20, sent_bytes: one.state.total_bytes });
  expect(told).toBe(20);
  expect(arrived.get("f 7.tif")).toBe(107);
  expect(most_at_once).toBeGreaterThan(1);
  expect(most_at_once).toBeLessThanOrEqual(4);
});

it("a file is sent again after a failure that passes", async () => {
  answers.set("b.tif", [503, 500]);
  const one = upload([item("a.tif"), item("b.tif")]);
  await one.run();
  expect(one.state.phase).toBe("done");
  expect([...arrived.keys()].sort()).toEqual(["a.tif", "b.tif"]);
});

it("a refusal stops the upload, names the file, and the rest can go on without it", async () => {
  answers.set("notes.tif", [415, 415]);
  const one = upload([item("notes.tif"), ...Array.from({ length: 30 }, (_, index) => item(`${index}.tif`))]);
  await one.run();
  expect(one.state).toMatchObject({
    phase: "failed",
    refused: "notes.tif",
    problem: { code: "frames.not_an_image", detail: "This is no image." },
  });
  expect(isRefused(one.state)).toBe(true);
  expect(one.unsent().map(({ name }) => name)).not.toContain("notes.tif");
  const rest = upload(one.unsent());
  await rest.run();
  expect(rest.state.phase).toBe("done");
  expect(arrived.size).toBe(30);
});

it("a server that is away is said, and nothing is given up: the same files can be tried again", async () => {
  answers.set("a.tif", [503, 503, 503, 503, 503, 503]);
  const one = upload([item("a.tif")]);
  await one.run();
  expect(one.state).toMatchObject({ phase: "failed", problem: { status: 503 } });
  expect(isRefused(one.state)).toBe(false);
  expect(one.unsent().map(({ name }) => name)).toEqual(["a.tif"]);
});

it("a stopped upload sends nothing more and tells the server nothing", async () => {
  let isTold = false;
  const one = upload(
    Array.from({ length: 200 }, (_, index) => item(`${index}.tif`)),
    async () => {
      isTold = true;
    },
  );
  const running = one.run();
  await new Promise((resolve) => setTimeout(resolve, 30));
  one.stop();
  await running;
  expect(one.state.phase).toBe("stopped");
  expect(arrived.size).toBeLessThan(200);
  expect(isTold).toBe(false);
});
