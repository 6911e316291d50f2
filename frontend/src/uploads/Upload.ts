import type { Announced, Plan, PlannedUpload, Problem } from "../client";
import { ProblemError, toProblem } from "../platform/problem";
import { type Away, Patience } from "./patience";
import type { Found, Role } from "./sorting";
import { type Progress, Tally } from "./tally";
import { Turns } from "./turns";

export type Item = Found & { role: Role };

export type UploadState = {
  phase: "sending" | "closing" | "done" | "failed" | "stopped";
  n_files: number;
  total_bytes: number;
  /** Arrived, now or earlier. */
  sent: Progress;
  /** Found to be on the server what they are here. */
  verified: Progress;
  /** Another tab, computer or program sends some of it. */
  isWaiting: boolean;
  /** The server is away; it is asked again and again. */
  away: Away | null;
  problem: Problem | null;
  /** Name of the file that the server refused. */
  refused: string | null;
};

/** Whether the server will say no to the same file again. */
export function isRefused({ refused, problem }: UploadState): boolean {
  return refused !== null && problem !== null;
}

/** What an upload does with the server and with files; the pieces are in `tus.ts`, `sha256.ts` and the client. */
export type Means = {
  plan: (files: Announced[]) => Promise<Plan>;
  send: (
    upload: PlannedUpload,
    content: Blob,
    tell: { onSent: (bytes: number) => void; onWaiting: (isWaiting: boolean) => void; signal: AbortSignal },
  ) => Promise<void>;
  /** Why the server refused an upload for good, if it did. */
  refusal: (upload: PlannedUpload) => Promise<Problem | null>;
  sha256: (file: Blob, onRead: (bytes: number) => void, signal: AbortSignal) => Promise<string>;
  /** Tell the server that all files are there; if it knows already, that is well too. */
  close: () => Promise<unknown>;
};

const SENT_AT_ONCE = 3;
const READ_AT_ONCE = 2;
const GROUPS_AT_ONCE = 2;
/** Files a plan; the server takes twice as many. */
const GROUP_FILES = 1000;
const GROUP_NAME_CHARACTERS = 400_000;
/** A plan, then one that verifies, and a few more for what did not arrive as it should. */
const MOST_ROUNDS = 6;
const TELL_EVERY_MS = 200;
const GONE = new Set([404, 409, 410, 460]);

/**
 * One upload. The server says what is missing, and that alone is sent; then every file is summed up here and compared
 * with what the server has. Nothing is remembered here: the same files given again, anywhere, go on where they were.
 */
export class Upload {
  state: UploadState;
  private readonly sending = new Turns(SENT_AT_ONCE);
  private readonly reading = new Turns(READ_AT_ONCE);
  private readonly grouping = new Turns(GROUPS_AT_ONCE);
  private readonly stopping = new AbortController();
  private readonly patience = new Patience((away) => this.tell({ away }), this.stopping.signal);
  private readonly listeners = new Set<() => void>();
  private readonly sent = new Tally<Item>();
  private readonly verified = new Tally<Item>();
  private told_ms = 0;

  constructor(
    private readonly items: Item[],
    private readonly means: Means,
  ) {
    this.state = {
      phase: "sending",
      n_files: items.length,
      total_bytes: items.reduce((sum, { file }) => sum + file.size, 0),
      sent: this.sent.progress(0),
      verified: this.verified.progress(0),
      isWaiting: false,
      away: null,
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
    try {
      await Promise.all(groupsOf(this.items).map((group) => this.grouping.take(() => this.bring(group))));
      this.tell({ phase: "closing" });
      await this.patience.through(() => this.means.close());
      this.tell({ phase: "done" });
    } catch (error) {
      if (this.state.phase === "stopped" || this.state.phase === "failed") return;
      this.tell({ phase: "failed", problem: toProblem(error) });
      this.stopping.abort();
    }
  }

  /** The files without the one that the server will never take. */
  acceptable(): Item[] {
    return this.items.filter(({ name }) => name !== this.state.refused);
  }

  /** Ask a server that was away at once. */
  tryNow(): void {
    this.patience.tryNow();
  }

  stop(): void {
    if (this.state.phase === "done") return;
    this.tell({ phase: "stopped" });
    this.stopping.abort();
  }

  /** Have the server get some files, all of them and as they are here. */
  private async bring(group: Item[]): Promise<void> {
    const right = new Set<Item>();
    const sums = new Map<Item, string>();
    for (let round = 0; round < MOST_ROUNDS; round += 1) {
      this.stopping.signal.throwIfAborted();
      const left = group.filter((item) => !right.has(item));
      const files = left.map((item) => announced(item, sums.get(item)));
      const plan = await this.patience.through(() => this.means.plan(files));
      const verifying = plan.present.map(({ file, sha256 }) =>
        this.verify(left[file] as Item, sha256, right, sums),
      );
      const sending = plan.uploads.map((upload) => this.sending.take(() => this.send(upload, left)));
      await Promise.all([...verifying, ...sending]);
      if (right.size === group.length) return;
    }
    throw new ProblemError(NOT_AS_HERE);
  }

  private async send(upload: PlannedUpload, items: Item[]): Promise<void> {
    this.stopping.signal.throwIfAborted();
    const files = upload.files.map((index) => items[index] as Item);
    const content = new Blob(files.map(({ file }) => file));
    this.sent.begin(upload.id, upload.offset_bytes);
    try {
      const tell = {
        onSent: (bytes: number) => {
          this.patience.gotThrough();
          this.note(() => this.sent.move(upload.id, bytes));
        },
        onWaiting: (isWaiting: boolean) => isWaiting !== this.state.isWaiting && this.tell({ isWaiting }),
        signal: this.stopping.signal,
      };
      await this.patience.through(() => this.means.send(upload, content, tell));
      this.sent.end(upload.id);
      for (const item of files) this.sent.add(item);
    } catch (error) {
      this.sent.end(upload.id);
      await this.sendingFailed(upload, error);
    }
    this.note(() => undefined);
  }

  /** An upload that is gone, or whose bytes did not arrive as they were, is planned anew; what is refused ends it all. */
  private async sendingFailed(upload: PlannedUpload, error: unknown): Promise<void> {
    const status = error instanceof ProblemError ? error.problem.status : -1;
    if (GONE.has(status)) return;
    const refusal =
      status >= 400 && status < 500 ? await this.patience.through(() => this.means.refusal(upload)) : null;
    if (refusal) {
      this.state = { ...this.state, refused: refusal.file ?? null };
      throw new ProblemError(refusal);
    }
    throw error;
  }

  private async verify(item: Item, sha256: string, right: Set<Item>, sums: Map<Item, string>): Promise<void> {
    this.sent.add(item);
    const key = `${item.role}/${item.name}`;
    this.verified.begin(key, 0);
    const own = sums.get(item) ?? (await this.readSum(item, key));
    this.verified.end(key);
    sums.set(item, own);
    if (own !== sha256) {
      this.sent.takeBack(item);
      return;
    }
    right.add(item);
    this.note(() => this.verified.add(item));
  }

  private readSum(item: Item, key: string): Promise<string> {
    const onRead = (bytes: number) => this.note(() => this.verified.move(key, bytes));
    return this.reading.take(() => {
      this.stopping.signal.throwIfAborted();
      return this.means.sha256(item.file, onRead, this.stopping.signal);
    });
  }

  private note(change: () => void): void {
    change();
    const now_ms = performance.now();
    if (now_ms - this.told_ms < TELL_EVERY_MS) return;
    this.told_ms = now_ms;
    this.tell({});
  }

  private tell(change: Partial<UploadState>): void {
    const { total_bytes } = this.state;
    const [sent, verified] = [this.sent.progress(total_bytes), this.verified.progress(total_bytes)];
    this.state = { ...this.state, sent, verified, ...change };
    for (const listener of this.listeners) listener();
  }
}

const NOT_AS_HERE: Problem = {
  type: "about:blank",
  title: "Not the same",
  status: 0,
  code: "upload.not_as_here",
  detail: "Some files are not on the server as they are here, although they were sent again and again.",
  hint: "Perhaps they change while they are sent: wait until the camera is done, then try again.",
};

function announced({ name, role, file }: Item, sha256: string | undefined): Announced {
  return { name, role, size_bytes: file.size, sha256: sha256 ?? null };
}

/** Files in the order in which people count, in parts that one plan takes. The same files make the same parts. */
export function groupsOf(items: Item[]): Item[][] {
  const order = new Intl.Collator("en", { numeric: true });
  const sorted = [...items].sort((a, b) =>
    a.role === b.role ? order.compare(a.name, b.name) : a.role < b.role ? -1 : 1,
  );
  const groups: Item[][] = [];
  let n_characters = 0;
  for (const item of sorted) {
    const last = groups.at(-1);
    if (last && last.length < GROUP_FILES && n_characters + item.name.length < GROUP_NAME_CHARACTERS) {
      last.push(item);
      n_characters += item.name.length;
    } else {
      groups.push([item]);
      n_characters = item.name.length;
    }
  }
  return groups;
}
