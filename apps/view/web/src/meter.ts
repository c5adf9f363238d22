/** What tests read of the page: latencies [ms], each from an event of the user to the picture that answers it (the
    running program's where there is one, else the map's); frames, shapes that were drawn. */
declare global {
  interface Window { softkinPage?: {readonly latencies: readonly number[]; readonly frames: number} }
}

const most = 10000;

/** The event that is being handled; outside of one, now [ms]. */
export const eventTime = (): number => window.event?.timeStamp ?? performance.now();

/** Measures how long answers take. */
export class Meter {
  private readonly latencies: number[] = [];
  private readonly asked = new Map<number, number>();
  private answered: number[] = [];
  private frames = 0;

  constructor() {
    const page = {};
    Object.defineProperty(page, 'latencies', {get: () => this.latencies.slice()});
    Object.defineProperty(page, 'frames', {get: () => this.frames});
    Object.defineProperty(window, 'softkinPage', {value: page});
  }

  ask(id: number, since: number): void { this.asked.set(id, since); }

  /** Shown by the picture that is drawn next, since that time. */
  show(since: number): void { this.answered = [since]; }

  /** Answered by the picture that is drawn next. */
  answer(id: number): void {
    const since = this.asked.get(id);
    if (since !== undefined) this.answered.push(since);
    for (const each of this.asked.keys()) if (each <= id) this.asked.delete(each);
  }

  drawn(): void {
    const now = performance.now();
    if (!this.answered.length) return;
    ++this.frames;
    this.latencies.push(...this.answered.map((since) => now - since));
    this.latencies.splice(0, Math.max(0, this.latencies.length - most));
    this.answered = [];
  }
}
