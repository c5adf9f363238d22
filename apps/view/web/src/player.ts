import type {Robot} from './robot';
import {byId, digits} from './text';

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

export interface Player { update(): void; toggle(): void; stop(): void; setTrack(track: Track): void }

/** How long one is shown [ms]: by its time, else so that all take some seconds. */
function pauseMs(track: Track, i: number): number {
  const now = track.time(i), next = track.time(i + 1);
  if (now !== null && next !== null) return Math.min(Math.max(1000 * (next - now), 20), 5000);
  return Math.min(Math.max(12000 / track.count, 60), 700);
}

export function makePlayer(robot: Robot): Player {
  const play = byId<HTMLButtonElement>('play'), slider = byId<HTMLInputElement>('step'), box = byId('player');
  let track: Track = new StepTrack(robot), timer = 0, moving = false;
  const last = () => track.count - 1;
  const stop = () => {
    clearTimeout(timer);
    timer = 0;
    play.textContent = 'Play';
  };
  const after = (ms: number) => { timer = window.setTimeout(goOn, ms); };
  const goOn = () => {
    if (robot.link?.busy) return after(15);  // each is answered before the next
    if (track.at < 0 || track.at >= last()) return stop();
    track.show(track.at + 1);
    if (timer) after(pauseMs(track, track.at));
  };
  const toggle = () => {
    if (track.count < 1 || play.disabled) return;
    if (timer) return stop();
    robot.remember();
    play.textContent = 'Pause';
    after(0);
    track.show(track.at < 0 || track.at === last() ? 0 : track.at + 1);
    clearTimeout(timer);
    after(pauseMs(track, track.at));
  };
  play.addEventListener('click', toggle);
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
    byId('step-text').textContent = time === null ? told : `${told}, ${digits(time, 3)} s`;
    slider.setAttribute('aria-valuetext', byId('step-text').textContent ?? told);
  };
  const setTrack = (next: Track) => {
    stop();
    track = next;
    box.hidden = track.count < 1;
    byId('step-label').textContent = track instanceof StepTrack ? 'Step' : 'Row';
    slider.max = String(Math.max(last(), 0));
    slider.value = '0';
    update();
  };
  setTrack(track);
  return {update, toggle, stop, setTrack};
}
