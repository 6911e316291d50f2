import type { Problem } from "../client";
import { ProblemError, UNREACHABLE } from "../platform/problem";

/** Nobody answers just now, and when it is asked again. */
export type Away = { problem: Problem; until_ms: number };

const PAUSES_MS = [2_000, 5_000, 10_000, 20_000, 40_000, 60_000];
/** A server that restarts, or whose storage or database does; or a proxy that says so. */
const PASSING = new Set([408, 429, 502, 503, 504]);

/**
 * Whatever is done through it is done again, for as long as the page is open, while the server is away. All wait
 * together: the pauses grow until something gets through, and end at once when the network comes back.
 */
export class Patience {
  private away: Away | null = null;
  private pause: Promise<void> | null = null;
  private n_pauses = 0;
  private endPause: () => void = () => undefined;

  constructor(
    private readonly tell: (away: Away | null) => void,
    private readonly signal: AbortSignal,
  ) {}

  /** Do it until it succeeds, or fails in another way than by the server being away. */
  async through<Result>(work: () => Promise<Result>): Promise<Result> {
    for (;;) {
      try {
        const result = await work();
        this.gotThrough();
        return result;
      } catch (error) {
        if (!isAway(error)) throw error;
        this.pause ??= this.begin(error.problem);
        await this.pause;
        this.signal.throwIfAborted();
      }
    }
  }

  /** The server is there: the next pause is a short one again. */
  gotThrough(): void {
    if (!this.away) return;
    this.away = null;
    this.n_pauses = 0;
    this.tell(null);
    this.endPause();
  }

  /** Ask at once. */
  tryNow = (): void => this.endPause();

  private begin(problem: Problem): Promise<void> {
    const pause_ms = PAUSES_MS[Math.min(this.n_pauses, PAUSES_MS.length - 1)] as number;
    this.n_pauses += 1;
    this.away = { problem, until_ms: Date.now() + pause_ms };
    this.tell(this.away);
    return new Promise((resolve) => {
      const timer = setTimeout(this.tryNow, pause_ms);
      window.addEventListener("online", this.tryNow);
      this.signal.addEventListener("abort", this.tryNow);
      this.endPause = () => {
        clearTimeout(timer);
        window.removeEventListener("online", this.tryNow);
        this.signal.removeEventListener("abort", this.tryNow);
        this.endPause = () => undefined;
        this.pause = null;
        if (this.away) this.tell({ ...this.away, until_ms: Date.now() });
        resolve();
      };
    });
  }
}

function isAway(error: unknown): error is ProblemError {
  return (
    error instanceof ProblemError &&
    (error.problem.code === UNREACHABLE.code || PASSING.has(error.problem.status))
  );
}
