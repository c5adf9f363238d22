/** A clock that a test moves, in place of setTimeout() and Date.now(): those of node:test differ between Node 18 and 20. */
export class FakeClock {
  private now = 0;
  private last = 0;
  private waiting: {id: number; at: number; call: () => void}[] = [];
  private readonly real = {setTimeout, clearTimeout, now: Date.now};

  install(): void {
    this.now = 0;
    this.waiting = [];
    Date.now = () => this.now;
    Object.assign(globalThis, {
      setTimeout: (call: () => void, after: number) => {
        this.waiting.push({id: ++this.last, at: this.now + after, call});
        return this.last;
      },
      clearTimeout: (id: number) => { this.waiting = this.waiting.filter((each) => each.id !== id); },
    });
  }

  uninstall(): void {
    Date.now = this.real.now;
    Object.assign(globalThis, {setTimeout: this.real.setTimeout, clearTimeout: this.real.clearTimeout});
  }

  /** Moves on by so many milliseconds, and makes the calls that are due, in their order. */
  tick(milliseconds: number): void {
    const end = this.now + milliseconds;
    for (;;) {
      const [first] = this.waiting.filter(({at}) => at <= end).sort((a, b) => a.at - b.at || a.id - b.id);
      if (!first) break;
      this.waiting = this.waiting.filter((each) => each !== first);
      this.now = first.at;
      first.call();
    }
    this.now = end;
  }
}
