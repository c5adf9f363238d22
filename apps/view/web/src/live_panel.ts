import type {Live, LiveState} from './live';
import {byId} from './text';

/** Who controls, in words; away: it was connected before. */
export function liveWords(state: LiveState, before: boolean): string {
  const {connected, secret, control, free, streamed, watchers} = state;
  if (!connected) return before ? 'softkin does not respond: trying again …' : 'Connecting to softkin …';
  const others = watchers > 0 ? ` ${watchers} window${watchers > 1 ? 's' : ''} watch${watchers > 1 ? '' : 'es'}.` : '';
  if (control) return `You control the robot.${others}`;
  if (streamed) return `Another program streams readings to softkin; this window watches.`;
  const who = free ? 'Nobody controls the robot.' : 'Another window controls the robot; this one watches.';
  return secret ? who : `${who} To control it, open the whole address that softkin printed.`;
}

/** Why the sliders are off; empty: they are on. */
export function whyOff({connected, control, secret, free, streamed}: LiveState): string {
  if (control) return '';
  if (!connected) return 'Off: softkin does not respond.';
  if (streamed) return 'Off: another program streams readings.';
  if (!secret) return 'Off: this window only watches.';
  return free ? 'Off: press "Take control" first.' : 'Off: another window has control. "Take control" takes it away.';
}

/** Who controls, and its button; returns what brings them up to date. */
export function makeLivePanel(live: Live): () => void {
  const button = byId<HTMLButtonElement>('control'), words = byId('live-words'), refused = byId('refused');
  let before = false;
  byId('live').hidden = false;
  button.addEventListener('click', () => {
    if (live.state.control) live.release();
    else live.take();
  });
  return () => {
    const {state} = live;
    before ||= state.connected;
    const text = liveWords(state, before), told = state.refused && `softkin refused: ${state.refused}`;
    if (words.textContent !== text) words.textContent = text;
    if (refused.textContent !== told) refused.textContent = told;
    words.className = state.connected ? '' : 'bad message';
    button.hidden = !state.connected || state.streamed || (!state.secret && !state.control);
    button.textContent = state.control ? 'Hand over' : 'Take control';
    button.classList.toggle('main', !state.control);
  };
}
