import assert from 'node:assert/strict';
import {test} from 'node:test';
import {unpack} from '../src/base64';
import {colourAt, paint, scaleOf} from '../src/colours';
import {digits, mm} from '../src/text';

test('arrays of base64 are little-endian numbers', () => {
  assert.deepEqual([...unpack({u16: 'AQACAf//'})], [1, 258, 65535]);
  assert.deepEqual([...unpack({i16: '//8AgA=='})], [-1, -32768]);
  assert.deepEqual([...unpack({u32: 'BAMCAQ=='})], [0x01020304]);
  assert.deepEqual([...unpack({f32: 'AACAPwAAAMA='})], [1, -2]);
  assert.deepEqual([...unpack({f64: 'AAAAAAAA8D8='})], [1]);
  assert.deepEqual([...unpack({u16: 'AAABAP//AQA=', low: [1, 10], step: [0.5, 2]})], [1, 12, 32768.5, 12]);
  assert.throws(() => unpack({u16: 'AAA=', low: [1, 10], step: [0.5]}), RangeError);
  assert.throws(() => unpack({f32: 'AAA='}), RangeError);
  assert.throws(() => unpack({}), TypeError);
});

/** WCAG 2: relative luminance. */
const luminance = (rgb: number[]) => rgb.map((c) => c / 255)
  .map((c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
  .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);

test('colours grow lighter all along, also to eyes that see none', () => {
  const grey = (k: number) => luminance(colourAt(k / 40, false));
  for (let k = 1; k <= 40; ++k) assert.ok(grey(k) > grey(k - 1));
  for (let k = 1; k <= 20; ++k) for (const side of [1, -1])
    assert.ok(luminance(colourAt(0.5 + side * k / 40, true)) < luminance(colourAt(0.5 + side * (k - 1) / 40, true)));
  assert.deepEqual(colourAt(-1, false), colourAt(0, false));
  assert.deepEqual(colourAt(NaN, false), colourAt(0, false));
});

test('a scale holds all values, about its middle where it has one', () => {
  assert.deepEqual(scaleOf([[1, 3], [2, 7]], null, false), {low: 1, high: 7, about: false});
  assert.deepEqual(scaleOf([[1, 3]], null, true), {low: 0, high: 3, about: false});
  assert.deepEqual(scaleOf([[0.5, 1.25]], 1, false), {low: 0.5, high: 1.5, about: true});
  const {low, high} = scaleOf([[2, 2]], null, false);
  assert.ok(high > low);
  const rgb = new Float32Array(6);
  paint([NaN, 9], {low: 0, high: 1, about: false}, rgb);
  assert.ok(rgb.every((c) => c >= 0 && c <= 1));
});

test('numbers are written as people read them', () => {
  assert.equal(digits(1234.5), '1235');
  assert.equal(digits(0.012345, 3), '0.0123');
  assert.equal(digits(-13.72, 3), '−13.7');
  assert.equal(digits(null), '–');
  assert.equal(mm(-0.001), '0.00');
});
