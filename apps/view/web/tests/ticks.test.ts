import assert from 'node:assert/strict';
import {test} from 'node:test';
import {labelledTicks, roundTicks} from '../src/ticks';

test('ticks are multiples of 1, 2 or 5 times a power of ten', () => {
  assert.deepEqual(roundTicks(0, 9.1, 6), [0, 2, 4, 6, 8]);
  assert.deepEqual(roundTicks(0, 0.31, 6), [0, 0.1, 0.2, 0.3]);
  assert.deepEqual(roundTicks(0.93, 1.07, 6), [0.95, 1, 1.05]);
  assert.deepEqual(roundTicks(-37, 110, 6), [0, 50, 100]);
  assert.deepEqual(roundTicks(3, 3, 6), [3]);
  for (let k = 0; k < 300; ++k) {
    const low = Math.sin(k) * 10 ** (k % 9 - 4), high = low + (1.01 + Math.cos(3 * k)) * 10 ** (k % 7 - 3);
    const ticks = roundTicks(low, high, 6), step = ticks[1] - ticks[0];
    const digit = step / 10 ** Math.floor(Math.log10(step) + 1e-6);
    assert.ok(ticks.length >= 2 && ticks.length <= 6, `${ticks.length} ticks from ${low} to ${high}`);
    assert.ok([1, 2, 5].some((d) => Math.abs(digit - d) < 1e-6), `a step of ${step}`);
    assert.ok(ticks[0] >= low - 1e-6 * step && ticks[ticks.length - 1] <= high + 1e-6 * step);
  }
});

test('labels have the digits of their step, and are fewer where they are long', () => {
  const labels = (low: number, high: number) => labelledTicks(low, high).map(({label}) => label);
  assert.deepEqual(labels(0, 9.1), ['0', '2', '4', '6', '8']);
  assert.deepEqual(labels(-0.15, 0.12), ['−0.1', '0.0', '0.1']);
  assert.ok(labels(0, 0.00031).join('').length <= 24);
});
