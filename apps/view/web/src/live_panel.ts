import type {Live, LiveState} from './live';
import {byId} from './text';

/** Describes who has control. before: there was a connection before. */
export function liveWords(state: LiveState, before: boolean): string {
  const {connected, secret, control, free, streamed, watchers} = state;
  if (!connected) return before ? 'softkin does not respond: trying again …' : 'Connecting to softkin …';
  const others = watchers > 0 ? ` ${watchers} window${watchers > 1 ? 's' : ''} watch${watchers > 1 ? '' : 'es'}.` : '';
  if (control) return `You control the robot.${others}`;
  if (streamed) return `Another program streams readings to softkin; this window watches.`;
  const who = free ? 'Nobody controls the robot.' : 'Another window controls the robot; this one watches.';
  return secret ? who : `${who} To control it, open the whole address that softkin printed.`;
}

/** Returns why the sliders are disabled; empty where they are not. */
export function whyOff({connected, control, secret, free, streamed}: LiveState): string {
  if (control) return '';
  if (!connected) return 'Off: softkin does not respond.';
  if (streamed) return 'Off: another program streams readings.';
  if (!secret) return 'Off: this window only watches.';
  return free ? 'Off: press "Take control" first.' : 'Off: another window has control. "Take control" takes it away.';
}

/** Shows who has control, with a button to take it or hand it over; returns the function that updates both. */
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
    const text = liveWords(state, before), refusal = state.refused && `softkin refused: ${state.refused}`;
    if (words.textContent !== text) words.textContent = text;
    if (refused.textContent !== refusal) refused.textContent = refusal;
    words.className = state.connected ? '' : 'bad message';
    button.hidden = !state.connected || state.streamed || (!state.secret && !state.control);
    button.textContent = state.control ? 'Hand over' : 'Take control';
    button.classList.toggle('main', !state.control);
  };
}
