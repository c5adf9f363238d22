import type {Robot} from './robot';
import {byId, element} from './text';

/** A sequence of shapes to play: the steps of the run, or the rows of a file. at: the index of the shown one, or -1. */
export interface Track {
  readonly name: string; readonly count: number; readonly at: number;
  time(i: number): number | null;
  show(i: number): void;
}

/** The computed steps. */
export class StepTrack implements Track {
  readonly name = 'computed steps';

  constructor(private readonly robot: Robot) {}

  get count(): number { return this.robot.steps.length; }

  get at(): number { return this.robot.pose.step; }

  time(i: number): number | null { return this.robot.steps[i]?.time ?? null; }

  show(i: number): void { this.robot.showStep(i); }
}

export interface Player {
  update(): void; toggle(): void; stop(): void; setTrack(track: Track): void;
  /** Plays from the first shape; ended is called once, at the end or when the user stops. */
  fromStart(ended: () => void): void;
}

/** A track of a longer duration is at first played faster than its times [s]. */
const longestS = 60;
const usualSpeeds = [0.25, 1, 4];

/** Rounds up to 1, 2 or 5 times a power of ten. */
function roundUp(value: number): number {
  const ten = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((n) => n * ten).find((n) => n >= value) ?? value;
}

/** Returns the speeds that a track offers, relative to its times, and the first one; none where it has no times. */
export function speedsOf(track: Pick<Track, 'count' | 'time'>): {speeds: number[]; first: number} {
  const begin = track.time(0), end = track.time(track.count - 1);
  if (begin === null || end === null || !(end > begin)) return {speeds: [], first: 1};
  const whole = end - begin, first = whole > longestS ? roundUp(2 * whole / longestS) : 1;
  return {speeds: usualSpeeds.includes(first) ? usualSpeeds : [...usualSpeeds, first], first};
}

/** Returns how long a shape is shown [ms]: in proportion to its time, or else so that all take some seconds. */
export function pauseMs(track: Pick<Track, 'count' | 'time'>, i: number, speed: number): number {
  const now = track.time(i), next = track.time(i + 1);
  if (now !== null && next !== null) return 1000 * (next - now) / speed;
  return Math.min(Math.max(12000 / track.count, 60), 700);
}

/** Formats a time: "t = 1.25 s". */
export const timeWords = (time: number): string => `t = ${Number(time.toPrecision(6))} s`.replace('-', '−');

export function makePlayer(robot: Robot): Player {
  const play = byId<HTMLButtonElement>('play'), slider = byId<HTMLInputElement>('step'), box = byId('player');
  const speed = byId<HTMLSelectElement>('speed');
  let track: Track = new StepTrack(robot), timer = 0, due = 0, moving = false, ended: (() => void) | null = null;
  const last = () => track.count - 1;
  const stop = () => {
    clearTimeout(timer);
    timer = 0;
    play.textContent = 'Play';
    const callback = ended;
    ended = null;
    callback?.();
  };
  const scheduleAt = (time: number) => {
    due = time;
    timer = window.setTimeout(advance, due - performance.now());
  };
  const pause = () => pauseMs(track, track.at, Number(speed.value) || 1);
  const advance = () => {
    if (robot.link?.busy) return scheduleAt(performance.now() + 15);  // waits for the answer before the next shape
    if (track.at < 0 || track.at >= last()) return stop();
    track.show(track.at + 1);
    if (timer) scheduleAt(due + pause());  // relative to the due time, so that drawing does not add up
  };
  const begin = (first: number) => {
    robot.remember();
    play.textContent = 'Pause';
    scheduleAt(performance.now());
    track.show(first);
    clearTimeout(timer);
    scheduleAt(performance.now() + pause());
  };
  const toggle = () => {
    if (track.count < 1 || play.disabled) return;
    if (timer) stop();
    else begin(track.at < 0 || track.at === last() ? 0 : track.at + 1);
  };
  const fromStart = (whenEnded: () => void) => {
    stop();
    ended = whenEnded;
    if (track.count < 1 || play.disabled) stop();
    else begin(0);
  };
  play.addEventListener('click', toggle);
  speed.addEventListener('change', () => {
    if (!timer) return;
    clearTimeout(timer);
    scheduleAt(performance.now() + pause());
  });
  slider.addEventListener('change', () => { moving = false; });
  slider.addEventListener('input', () => {
    stop();
    if (!moving) robot.remember();
    moving = true;
    track.show(Number(slider.value));
  });
  const update = () => {
    const {at, count, name} = track, time = track.time(at);
    play.disabled = slider.disabled = !(track instanceof StepTrack) && !robot.able;
    if (timer && (at < 0 || play.disabled)) stop();
    if (at >= 0) slider.value = String(at);
    const text = at < 0 ? `${count} ${name}` : `${at + 1} of ${count}`;
    byId('step-text').textContent = time === null ? text : `${text}, ${timeWords(time)}`;
    slider.setAttribute('aria-valuetext', byId('step-text').textContent ?? text);
  };
  const setTrack = (next: Track) => {
    stop();
    track = next;
    box.hidden = track.count < 1;
    byId('step-label').textContent = track instanceof StepTrack ? 'Step' : 'Row';
    slider.max = String(Math.max(last(), 0));
    slider.value = '0';
    offerSpeeds(speed, track);
    update();
  };
  setTrack(track);
  return {update, toggle, stop, setTrack, fromStart};
}

/** Fills the list of speeds; hides it where the track has no times. */
function offerSpeeds(box: HTMLSelectElement, track: Track): void {
  const {speeds, first} = speedsOf(track);
  box.replaceChildren(...speeds.map((speed) => element('option', {value: speed}, `${speed} ×`)));
  box.value = String(first);
  byId('speed-label').hidden = !speeds.length;
}
