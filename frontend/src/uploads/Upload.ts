import type { Problem } from "../client";
import { toProblem } from "../platform/problem";
import { Rate } from "./rate";
import { isPassing, sendFile } from "./sending";
import type { Found, Role } from "./sorting";

export type Item = Found & { role: Role };

export type UploadState = {
  phase: "sending" | "closing" | "done" | "failed" | "stopped";
  n_files: number;
  n_sent: number;
  total_bytes: number;
  sent_bytes: number;
  bytes_per_s: number | null;
  seconds_left: number | null;
  problem: Problem | null;
  /** Name of the file that the server refused. */
  refused: string | null;
};

/** Whether the server will say no to the same file again. */
export function isRefused({ refused, problem }: UploadState): boolean {
  return refused !== null && problem !== null && !isPassing(problem);
}

type Destination = {
  /** Where one file goes. */
  urlOf: (item: Item) => string;
  /** Tell the server that all files are there. */
  close: () => Promise<unknown>;
};

const AT_ONCE = 4;
const TELL_EVERY_MS = 200;

/** One upload: several files at a time, each tried again after a passing failure, stopped by the first refusal. */
export class Upload {
  state: UploadState;
  private readonly queue: Item[];
  private readonly moving = new Map<Item, number>();
  private readonly rate = new Rate();
  private readonly stopping = new AbortController();
  private readonly listeners = new Set<() => void>();
  private done_bytes = 0;
  private told_ms = 0;

  constructor(
    items: Item[],
    private readonly destination: Destination,
    /** Before a file is tried again; twice as long each time. */
    private readonly firstWait_ms = 500,
  ) {
    this.queue = [...items];
    this.state = {
      phase: "sending",
      n_files: items.length,
      n_sent: 0,
      total_bytes: items.reduce((sum, { file }) => sum + file.size, 0),
      sent_bytes: 0,
      bytes_per_s: null,
      seconds_left: null,
      problem: null,
      refused: null,
    };
  }

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  getState = (): UploadState => this.state;

  async run(): Promise<void> {
    this.rate.add(performance.now(), 0);
    try {
      await Promise.all(Array.from({ length: AT_ONCE }, () => this.sendNext()));
      this.tell({ phase: "closing", sent_bytes: this.state.total_bytes, seconds_left: null });
      await this.destination.close();
      this.tell({ phase: "done" });
    } catch (error) {
      if (this.state.phase === "stopped") return;
      this.stopping.abort();
      this.tell({ phase: "failed", problem: toProblem(error), seconds_left: null });
    }
  }

  /** What has not arrived and may: files in flight and those after them. */
  unsent(): Item[] {
    return [...this.moving.keys(), ...this.queue].filter(
      ({ name }) => !isRefused(this.state) || name !== this.state.refused,
    );
  }

  stop(): void {
    this.tell({ phase: "stopped", seconds_left: null });
    this.stopping.abort();
  }

  private async sendNext(): Promise<void> {
    for (let item = this.queue.shift(); item; item = this.queue.shift()) {
      const current = item;
      this.moving.set(current, 0);
      try {
        await sendFile(
          this.destination.urlOf(current),
          current.file,
          (bytes) => this.progress(current, bytes),
          this.stopping.signal,
          this.firstWait_ms,
        );
      } catch (error) {
        if (!this.stopping.signal.aborted) this.tell({ refused: current.name });
        throw error;
      }
      this.moving.delete(current);
      this.done_bytes += current.file.size;
      this.progress(null, 0, { n_sent: this.state.n_sent + 1 });
    }
  }

  private progress(item: Item | null, bytes: number, more: Partial<UploadState> = {}): void {
    if (item) this.moving.set(item, Math.min(bytes, item.file.size));
    const now_ms = performance.now();
    const sent_bytes = [...this.moving.values()].reduce((sum, part) => sum + part, this.done_bytes);
    this.rate.add(now_ms, sent_bytes);
    this.state = { ...this.state, ...more, sent_bytes };
    if (now_ms - this.told_ms < TELL_EVERY_MS) return;
    this.told_ms = now_ms;
    this.tell({
      bytes_per_s: this.rate.bytesPerSecond(),
      seconds_left: this.rate.secondsLeft(this.state.total_bytes),
    });
  }

  private tell(change: Partial<UploadState>): void {
    this.state = { ...this.state, ...change };
    for (const listener of this.listeners) listener();
  }
}
