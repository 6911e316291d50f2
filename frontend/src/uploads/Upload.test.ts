import { expect, it, vi } from "vitest";
import type { Announced, Plan, Problem } from "../client";
import { ProblemError } from "../platform/problem";
import { groupsOf, type Item, isRefused, type Means, Upload } from "./Upload";

/** What the service keeps of files, in this process: plans, broken-off uploads and checksums as it has them. */
class Store implements Means {
  readonly files = new Map<string, string>();
  readonly planned = new Map<string, { files: Announced[]; offset_bytes: number }>();
  readonly refusals = new Map<string, Problem>();
  sent_bytes = 0;
  n_at_once = 0;
  most_at_once = 0;
  n_closed = 0;
  /** Asked before each sending; an error breaks it off. */
  fault: (name: string) => Error | null = () => null;

  async plan(files: Announced[]): Promise<Plan> {
    const plan: Plan = { uploads: [], present: [] };
    for (const [file, { name, sha256 }] of files.entries()) {
      const kept = this.files.get(name);
      if (kept !== undefined && (!sha256 || sha256 === kept)) plan.present.push({ file, sha256: kept });
      else {
        const id = `upload of ${name}`;
        const begun = this.planned.get(id) ?? { files: [files[file] as Announced], offset_bytes: 0 };
        this.planned.set(id, begun);
        const size_bytes = files[file]?.size_bytes ?? 0;
        plan.uploads.push({ id, location: "", size_bytes, offset_bytes: begun.offset_bytes, files: [file] });
      }
    }
    return plan;
  }

  send: Means["send"] = async ({ id, offset_bytes }, content, { onSent, signal }) => {
    this.most_at_once = Math.max(this.most_at_once, ++this.n_at_once);
    const name = this.planned.get(id)?.files[0]?.name ?? "";
    await new Promise((resolve) => setTimeout(resolve, 2));
    this.n_at_once -= 1;
    signal.throwIfAborted();
    const fault = this.fault(name);
    if (fault) throw fault;
    onSent(content.size);
    this.sent_bytes += content.size - offset_bytes;
    this.files.set(name, await sumOf(content));
    this.planned.delete(id);
  };

  refusal: Means["refusal"] = async ({ id }) => this.refusals.get(id) ?? null;
  sha256: Means["sha256"] = (file, onRead) => {
    onRead(file.size);
    return sumOf(file);
  };
  close = async () => {
    this.n_closed += 1;
  };
}

async function sumOf(content: Blob): Promise<string> {
  return String(
    new Uint8Array(await content.arrayBuffer()).reduce((sum, byte) => (sum * 31 + byte) % 1e9, 7),
  );
}

function item(name: string, fill = 1, size = 1000): Item {
  return { name, file: new File([new Uint8Array(size).fill(fill)], name), role: "frames" };
}

const FILES = Array.from({ length: 20 }, (_, index) => item(`f ${index}.tif`, index, 100 + index));
const failure = (status: number) =>
  new ProblemError({ type: "", title: "", status, code: "x", detail: "This went wrong." });

it("every file arrives, a few at a time, is found to be the same, and then the server is told", async () => {
  const store = new Store();
  const upload = new Upload(FILES, store);
  await upload.run();
  expect(upload.state).toMatchObject({ phase: "done", sent: { n_files: 20 }, verified: { n_files: 20 } });
  expect(upload.state.verified.n_bytes).toBe(upload.state.total_bytes);
  expect(store.files.size).toBe(20);
  expect(store.n_closed).toBe(1);
  expect(store.most_at_once).toBe(3);
});

it("the same files again send nothing, and half of them only the other half", async () => {
  const store = new Store();
  await new Upload(FILES.slice(0, 10), store).run();
  const half_bytes = store.sent_bytes;
  await new Upload(FILES, store).run();
  const all_bytes = store.sent_bytes;
  expect(all_bytes).toBeGreaterThan(half_bytes);
  await new Upload(FILES, store).run();
  expect(store.sent_bytes).toBe(all_bytes);
});

it("a file of the same name and size with other content is sent anew", async () => {
  const store = new Store();
  await new Upload([item("a.tif", 1)], store).run();
  const before = store.files.get("a.tif");
  const again = new Upload([item("a.tif", 2)], store);
  await again.run();
  expect(again.state.phase).toBe("done");
  expect(store.files.get("a.tif")).not.toBe(before);
});

it("an upload that is gone on the server is planned anew", async () => {
  const store = new Store();
  let n_faults = 0;
  store.fault = () => (n_faults++ < 2 ? failure(404) : null);
  const upload = new Upload(FILES, store);
  await upload.run();
  expect(upload.state.phase).toBe("done");
  expect(store.files.size).toBe(20);
});

it("a refusal stops the upload, names the file, and the rest can go on without it", async () => {
  const store = new Store();
  const problem = { ...failure(415).problem, file: "notes.tif" };
  store.refusals.set("upload of notes.tif", problem);
  store.fault = (name) => (name === "notes.tif" ? failure(415) : null);
  const upload = new Upload([item("notes.tif"), ...FILES], store);
  await upload.run();
  expect(upload.state).toMatchObject({ phase: "failed", refused: "notes.tif", problem });
  expect(isRefused(upload.state)).toBe(true);
  const rest = new Upload(upload.acceptable(), store);
  await rest.run();
  expect(rest.state.phase).toBe("done");
  expect(store.files.size).toBe(20);
});

it("a full disk is said, what arrived stays, and the same files go on later", async () => {
  const store = new Store();
  store.fault = (name) => (name === "f 15.tif" ? failure(507) : null);
  const upload = new Upload(FILES, store);
  await upload.run();
  expect(upload.state).toMatchObject({ phase: "failed", problem: { status: 507 }, refused: null });
  expect(store.n_closed).toBe(0);
  const arrived_bytes = store.sent_bytes;
  store.fault = () => null;
  const again = new Upload(upload.acceptable(), store);
  await again.run();
  expect(again.state.phase).toBe("done");
  expect(store.sent_bytes).toBe(again.state.total_bytes);
  expect(arrived_bytes).toBeGreaterThan(0);
});

it("a server that is away is asked again until it is back, and the upload goes on by itself", async () => {
  vi.useFakeTimers();
  const store = new Store();
  let isAway = true;
  store.fault = (name) => (isAway && name === "f 15.tif" ? failure(503) : null);
  const upload = new Upload(FILES, store);
  const running = upload.run();
  await vi.advanceTimersByTimeAsync(600_000);
  expect(upload.state).toMatchObject({ phase: "sending", away: { problem: { status: 503 } } });
  isAway = false;
  upload.tryNow();
  await vi.advanceTimersByTimeAsync(1000);
  await running;
  vi.useRealTimers();
  expect(upload.state).toMatchObject({ phase: "done", away: null });
  expect(store.files.size).toBe(20);
});

it("a stopped upload sends nothing more and tells the server nothing", async () => {
  const store = new Store();
  const upload = new Upload(FILES, store);
  const running = upload.run();
  await new Promise((resolve) => setTimeout(resolve, 5));
  upload.stop();
  await running;
  expect(upload.state.phase).toBe("stopped");
  expect(store.files.size).toBeLessThan(20);
  expect(store.n_closed).toBe(0);
});

it("twenty thousand files go in a few plans, the same each time", () => {
  const many = Array.from({ length: 20_000 }, (_, index) => item(`film/${index}.tif`, 0, 1));
  const groups = groupsOf(many);
  expect(groups).toHaveLength(20);
  expect(groups[0]?.[10]?.name).toBe("film/10.tif");
  expect(groupsOf([...many].reverse()).map((group) => group.length)).toEqual(
    groups.map((group) => group.length),
  );
});
