import type {Robot} from './robot';
import {byId, element} from './text';

/** What is played: the steps of the run, or the rows of a file. at: the one that is shown, or -1. */
export interface Track {
  readonly name: string; readonly count: number; readonly at: number;
  time(i: number): number | null;
  show(i: number): void;
}

/** The steps that softkin computed. */
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
  /** Plays from the first on; ended is called once, where it ends or is stopped. */
  fromStart(ended: () => void): void;
}

/** A track with times that takes longer is played faster at first [s]. */
const longestS = 60;
const usualSpeeds = [0.25, 1, 4];

/** 1, 2 or 5 times a power of ten, as large or larger. */
function roundUp(value: number): number {
  const ten = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((n) => n * ten).find((n) => n >= value) ?? value;
}

/** How many times faster than its times a track may be played, and is at first; none: it has no times. */
export function speedsOf(track: Pick<Track, 'count' | 'time'>): {speeds: number[]; first: number} {
  const begin = track.time(0), end = track.time(track.count - 1);
  if (begin === null || end === null || !(end > begin)) return {speeds: [], first: 1};
  const whole = end - begin, first = whole > longestS ? roundUp(2 * whole / longestS) : 1;
  return {speeds: usualSpeeds.includes(first) ? usualSpeeds : [...usualSpeeds, first], first};
}

/** How long one is shown [ms]: in proportion to its time, else so that all take some seconds. */
export function pauseMs(track: Pick<Track, 'count' | 'time'>, i: number, speed: number): number {
  const now = track.time(i), next = track.time(i + 1);
  if (now !== null && next !== null) return 1000 * (next - now) / speed;
  return Math.min(Math.max(12000 / track.count, 60), 700);
}

/** "t = 1.25 s". */
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
    const tell = ended;
    ended = null;
    tell?.();
  };
  const until = (time: number) => {
    due = time;
    timer = window.setTimeout(goOn, due - performance.now());
  };
  const pause = () => pauseMs(track, track.at, Number(speed.value) || 1);
  const goOn = () => {
    if (robot.link?.busy) return until(performance.now() + 15);  // each is answered before the next
    if (track.at < 0 || track.at >= last()) return stop();
    track.show(track.at + 1);
    if (timer) until(due + pause());  // what drawing took is made up for
  };
  const begin = (first: number) => {
    robot.remember();
    play.textContent = 'Pause';
    until(performance.now());
    track.show(first);
    clearTimeout(timer);
    until(performance.now() + pause());
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
    until(performance.now() + pause());
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
    const told = at < 0 ? `${count} ${name}` : `${at + 1} of ${count}`;
    byId('step-text').textContent = time === null ? told : `${told}, ${timeWords(time)}`;
    slider.setAttribute('aria-valuetext', byId('step-text').textContent ?? told);
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

/** Nothing where the track has no times. */
function offerSpeeds(box: HTMLSelectElement, track: Track): void {
  const {speeds, first} = speedsOf(track);
  box.replaceChildren(...speeds.map((speed) => element('option', {value: speed}, `${speed} ×`)));
  box.value = String(first);
  byId('speed-label').hidden = !speeds.length;
}
