import assert from 'node:assert/strict';
import {test} from 'node:test';
import {lineOf, quoted, sceneOf, wordsOf} from '../src/command_line';
import {readDocument, robotName} from '../src/document';
import type {Robot} from '../src/robot';
import {readState, yamlOf} from '../src/state';
import {vtuOf} from '../src/vtu';

const packed = (array: Float32Array | Uint32Array | Uint16Array) =>
  Buffer.from(array.buffer, array.byteOffset, array.byteLength).toString('base64');
const f32 = (...values: number[]) => ({f32: packed(Float32Array.from(values))});
const u32 = (...values: number[]) => ({u32: packed(Uint32Array.from(values))});
const step = {commands: [null, 1], loads: [null, 2], markers: [[1, null, 3]], status: 'converged', remark: '',
              iterations: 3, seconds: 0.5, time_s: 0.25, positions: f32(0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5),
              fields: {strain: f32(1, 2, 3, 4)}};
const whole = {
  softkin: '0.1.0', robot: '/a/b/my finger.yaml', formulation: 'physical',
  command: `softkin fk '/a/b/my finger.yaml' --path p.csv --html=o.html --stable --force 'load=0,0,1' --solver newton`,
  actuators: [{name: 'air', kind: 'pneumatic', control: 'pressure', unit: 'kPa', low: 0, high: 9, rest: 0,
               load_unit: ''},
              {name: 'it\'s', kind: 'cable', control: 'length', unit: '', low: 0.5, high: 1, rest: 1, load_unit: 'N'}],
  markers: [{name: 'tip', at: [1, 2, 3]}], regions: ['body'],
  surface: {rest: step.positions, triangles: u32(0, 1, 2), region: {u16: packed(Uint16Array.of(65535))}},
  cables: [], obstacles: [{points: f32(0, 0, 0, 1, 0, 0, 0, 1, 0), triangles: u32(0, 1, 2)}],
  bodies: {triangles: u32(0, 1, 3)}, map: null, steps: [step],
  workspace: {marker: 0, points: f32(1, 2, 3), colour: f32(7)},
};
const read = (more: object = {}) => readDocument(JSON.stringify({...whole, ...more}));

test('a document is read as softkin writes it', () => {
  const found = read();
  assert.ok(found);
  assert.equal(robotName(found), 'my finger');
  assert.deepEqual([...found.bodies], [0, 1, 3]);
  assert.deepEqual([...found.obstacles[0].triangles], [0, 1, 2]);
  assert.deepEqual([...found.region], [65535]);
  assert.deepEqual(found.steps[0].commands, [NaN, 1]);
  assert.deepEqual(found.steps[0].markers, [[1, NaN, 3]]);
  assert.equal(found.steps[0].time, 0.25);
  assert.deepEqual([...found.steps[0].fields.strain], [1, 2, 3, 4]);
  assert.deepEqual([...found.workspace?.points ?? []], [1, 2, 3]);
  assert.equal(found.live, null);
  assert.equal(readDocument('null'), null);
});

test('numbers that do not fit together are refused', () => {
  assert.throws(() => read({bodies: {triangles: u32(0, 1, 4)}}), RangeError);
  assert.throws(() => read({steps: [{...step, positions: f32(1, 2, 3)}]}), RangeError);
  assert.throws(() => read({steps: [{...step, fields: {strain: f32(1)}}]}), RangeError);
  assert.throws(() => read({workspace: {marker: 0, points: f32(1, 2)}}), RangeError);
});

test('a line for a terminal keeps the scene and the solver\'s options', () => {
  const found = read();
  assert.ok(found);
  assert.equal(sceneOf(found), '/a/b/my finger.yaml');
  assert.equal(lineOf(found, [4.5, 0.75]), `softkin fk '/a/b/my finger.yaml' --stable --force load=0,0,1 ` +
    `--solver newton --set air=4.5kPa --set 'it'\\''s=0.75'`);
  for (const word of ['a b', 'it\'s', 'plain', '$x "y" \\z', 'ü'])
    assert.deepEqual(wordsOf(`x ${quoted(word)} y`), ['x', word, 'y']);
});

test('a state that was saved is read again', () => {
  const found = read();
  assert.ok(found);
  const robot = {document: found, pose: {commands: [4.5, 0.75], markers: [[1, 2, 3]]}, target: null};
  const text = yamlOf(robot as unknown as Robot);
  assert.match(text, /^markers_mm:\n  "tip": \[1, 2, 3\]\n/m);
  assert.deepEqual(readState(text, found.actuators), [4.5, 0.75]);
  assert.deepEqual(readState('commands:\n  air: 2\n', found.actuators), [2, 1]);
  for (const [wrong, what] of [['commands:\n  wind: 1', /^Line 2: there is no actuator wind/], ['a: 1', /no commands/],
                               ['commands:\n  air: much', /must be a number/],
                               ['commands:\n  air: 10', /0 to 9 kPa/]] as const)
    assert.throws(() => readState(wrong, found.actuators), (error) => what.test(String((error as Error).message)));
});

test('a surface is written for VTK without vertices that it does not have', () => {
  const positions = Float32Array.of(9, 9, 9, 0, 0, 0, 1.5, 0, 0, 0, 1, 0), region = Uint16Array.of(65535);
  const text = vtuOf({positions, region, triangles: Uint32Array.of(1, 2, 3), vectors: {},
                      scalars: {'a<b': Float32Array.of(9, 1, 2, NaN)}});
  assert.match(text, /NumberOfPoints="3" NumberOfCells="1"/);
  assert.match(text, /Name="Points" NumberOfComponents="3" format="ascii">\n0 0 0 1.5 0 0 0 1 0\n/);
  assert.match(text, /Name="connectivity" format="ascii">\n0 1 2\n/);
  assert.match(text, /Name="a&lt;b" format="ascii">\n1 2 nan\n/);
  assert.match(text, /Name="region" format="ascii">\n-1\n/);
});
