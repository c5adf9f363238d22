/** Measurements for tests of the page. latencies: times from an event of the user to the picture that answers it [ms],
    with the shape of the running softkin where there is one, else of the map; frames: the number of drawn shapes. */
declare global {
  interface Window { softkinPage?: {readonly latencies: readonly number[]; readonly frames: number} }
}

const maxLatencies = 10000;

/** Returns the time of the event that is being handled, or else the present time [ms]. */
export const eventTime = (): number => window.event?.timeStamp ?? performance.now();

/** Measures the latencies. */
export class Meter {
  private readonly latencies: number[] = [];
  private readonly requests = new Map<number, number>();
  private answered: number[] = [];
  private frames = 0;

  constructor() {
    const page = {};
    Object.defineProperty(page, 'latencies', {get: () => this.latencies.slice()});
    Object.defineProperty(page, 'frames', {get: () => this.frames});
    Object.defineProperty(window, 'softkinPage', {value: page});
  }

  /** Notes a request with the time of its event. */
  request(id: number, since: number): void { this.requests.set(id, since); }

  /** Notes that the next drawn picture answers an event of that time. */
  show(since: number): void { this.answered = [since]; }

  /** Notes that the next drawn picture answers a request. */
  answer(id: number): void {
    const since = this.requests.get(id);
    if (since !== undefined) this.answered.push(since);
    for (const each of this.requests.keys()) if (each <= id) this.requests.delete(each);
  }

  drawn(): void {
    const now = performance.now();
    if (!this.answered.length) return;
    ++this.frames;
    this.latencies.push(...this.answered.map((since) => now - since));
    this.latencies.splice(0, Math.max(0, this.latencies.length - maxLatencies));
    this.answered = [];
  }
}
