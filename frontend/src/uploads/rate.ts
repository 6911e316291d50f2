/** How fast bytes go, over the last seconds: steady enough to read, quick enough to notice a stall. */

const WINDOW_MS = 8_000;

export class Rate {
  private samples: { at_ms: number; bytes: number }[] = [];

  add(at_ms: number, bytes: number): void {
    this.samples.push({ at_ms, bytes });
    while (this.samples.length > 2 && at_ms - (this.samples[1]?.at_ms ?? at_ms) >= WINDOW_MS)
      this.samples.shift();
  }

  bytesPerSecond(): number | null {
    const [first, last] = [this.samples[0], this.samples.at(-1)];
    if (!first || !last || last.at_ms - first.at_ms < 500) return null;
    return Math.max(0, ((last.bytes - first.bytes) / (last.at_ms - first.at_ms)) * 1000);
  }
}
