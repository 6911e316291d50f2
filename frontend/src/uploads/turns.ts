/** At most `n` of what is given to it go on at once; the others wait for their turn, in the order they came. */
export class Turns {
  private readonly waiting: (() => void)[] = [];

  constructor(private n: number) {}

  async take<Result>(work: () => Promise<Result>): Promise<Result> {
    if (this.n > 0) this.n -= 1;
    else await new Promise<void>((resolve) => this.waiting.push(resolve));
    try {
      return await work();
    } finally {
      const next = this.waiting.shift();
      if (next) next();
      else this.n += 1;
    }
  }
}
