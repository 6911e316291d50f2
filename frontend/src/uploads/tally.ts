import { Rate } from "./rate";

/** How one of the things that happen to files goes. */
export type Progress = {
  n_files: number;
  n_bytes: number;
  bytes_per_s: number | null;
  seconds_left: number | null;
};

/** Files and bytes that are done, with those of which a part is. */
export class Tally<Item extends { file: Blob }> {
  private readonly done = new Set<Item>();
  private readonly moving = new Map<string, { begun: number; reached: number }>();
  private readonly rate = new Rate();
  private done_bytes = 0;
  /** Brought about now, not found done: only these tell the speed. */
  private moved_bytes = 0;

  begin(key: string, bytes: number): void {
    this.moving.set(key, { begun: bytes, reached: bytes });
  }

  move(key: string, bytes: number): void {
    const part = this.moving.get(key);
    if (!part) return;
    this.moved_bytes += Math.max(0, bytes - part.reached);
    part.reached = bytes;
    this.rate.add(performance.now(), this.moved_bytes);
  }

  end(key: string): void {
    this.moving.delete(key);
  }

  add(item: Item): void {
    if (this.done.has(item)) return;
    this.done.add(item);
    this.done_bytes += item.file.size;
  }

  takeBack(item: Item): void {
    if (this.done.delete(item)) this.done_bytes -= item.file.size;
  }

  progress(total_bytes: number): Progress {
    const n_bytes = [...this.moving.values()].reduce((sum, { reached }) => sum + reached, this.done_bytes);
    const bytes_per_s = this.rate.bytesPerSecond();
    const left = total_bytes - n_bytes;
    return {
      n_files: this.done.size,
      n_bytes,
      bytes_per_s: left > 0 ? bytes_per_s : null,
      seconds_left: bytes_per_s && left > 0 ? left / bytes_per_s : null,
    };
  }
}
