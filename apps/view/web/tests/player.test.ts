import assert from 'node:assert/strict';
import {test} from 'node:test';
import {pauseMs, speedsOf, timeWords} from '../src/player';

const track = (times: (number | null)[]) => ({count: times.length, time: (i: number) => times[i] ?? null});

test('steps are shown for as long as they take, at the speed that is chosen', () => {
  const steps = track([0, 0.25, 20]);
  assert.equal(pauseMs(steps, 0, 1), 250);
  assert.equal(pauseMs(steps, 1, 1), 19750);
  assert.equal(pauseMs(steps, 1, 4), 19750 / 4);
  assert.deepEqual(speedsOf(steps), {speeds: [0.25, 1, 4], first: 1});
});

test('a path of hours takes no hours', () => {
  for (const [end, first] of [[60, 1], [61, 5], [600, 20], [7200, 500], [3e6, 100000]]) {
    const found = speedsOf(track([0, 1, end]));
    assert.equal(found.first, first);
    assert.ok(found.speeds.includes(first) && end / first <= 60);
  }
});

test('steps without times have no speed, and all are shown in some seconds', () => {
  assert.deepEqual(speedsOf(track([null, null])).speeds, []);
  assert.deepEqual(speedsOf(track([3])).speeds, []);
  assert.deepEqual(speedsOf(track([])).speeds, []);
  assert.equal(pauseMs(track([null, null]), 0, 4), 700);
});

test('times are told with their unit', () => {
  assert.equal(timeWords(1.25), 't = 1.25 s');
  assert.equal(timeWords(0), 't = 0 s');
  assert.equal(timeWords(0.1 + 0.2), 't = 0.3 s');
  assert.equal(timeWords(-2), 't = −2 s');
});
