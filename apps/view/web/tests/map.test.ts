import assert from 'node:assert/strict';
import {test} from 'node:test';
import {exported, type MapAnswers} from '../src/exported_map';
import {KinematicMap, type MapDocument} from '../src/map';

/** Of one input u from 0 to 2, x = u - 1: (1 + 2 T1 + 3 T2, 4 T1, 5) and a pressure 6 T1. */
const packed = (...values: number[]) => Buffer.from(Float64Array.from(values).buffer).toString('base64');
const line: MapDocument = {
  name: 'line', markers: ['tip'],
  inputs: [{name: 'air', unit: '', low: 0, high: 2}],
  outputs: ['tip_x', 'tip_y', 'tip_z', 'air_pressure'].map((name) =>
    ({name, unit: 'mm', accuracy: 0.01, largestError: 0.01, meanError: 0.001})),
  checked: {points: 1, outside: 0, equilibria: 3},
  tables: {
    pieces: [0], variables: [[0]], roots: [0], nodes: [[0]], cables: [], boxes: [[[0, 2]]],
    outputs: {size: 4, highest: [2], cells: [0, 1], terms: [0, 3], runs: [3],
              coefficients: packed(1, 0, 5, 0, 2, 4, 0, 6, 3, 0, 0, 0)},
    modes: {size: 1, highest: [1], cells: [0, 1], terms: [0, 2], runs: [2], coefficients: packed(0, 7)},
  },
  shapeTables: {mean: Buffer.from(Float32Array.of(1, 2, 3).buffer).toString('base64'), units: [0.5],
                modes: Buffer.from(Int16Array.of(2, 0, -4).buffer).toString('base64')},
};

test('outputs and slopes are those of the polynomials', () => {
  const map = new KinematicMap(line);
  for (const u of [0, 0.3, 1, 1.7, 2]) {
    const x = u - 1, found = map.fk([u]);
    assert.ok(found);
    [1 + 2 * x + 3 * (2 * x * x - 1), 4 * x, 5, 6 * x].forEach((value, q) =>
      assert.ok(Math.abs(found.outputs[q] - value) < 1e-12, `output ${q} at ${u}`));
    [2 + 12 * x, 4, 0, 6].forEach((slope, q) => assert.ok(Math.abs(found.jacobian[q][0] - slope) < 1e-12));
    const shape = map.shape([u]);
    [1 + 7 * x, 2, 3 - 14 * x].forEach((value, k) => assert.ok(shape && Math.abs(shape[k] - value) < 1e-5));
  }
});

test('commands out of range have no answer, wrong ones are refused', () => {
  const map = new KinematicMap(line);
  assert.equal(map.fk([2.01]), null);
  assert.equal(map.shape([-0.01]), null);
  assert.equal(map.fk([NaN]), null);
  assert.throws(() => map.fk([1, 1]), TypeError);
});

/** As softkin would answer at u: outputs and slopes of the polynomials, input 0 moved once its range. */
const answersAt = (...commands: number[]): MapAnswers => ({
  commands: commands.map((u) => [u]),
  outputs: commands.map((u) => [1 + 2 * (u - 1) + 3 * (2 * (u - 1) ** 2 - 1), 4 * (u - 1), 5, 6 * (u - 1)]),
  slopes: commands.map((u) => [2 * (2 + 12 * (u - 1)), 8, 0, 12]),
  outputScale: [10, 10, 10, 10], slopeScale: [10, 10, 10, 10],
});

test('inverse kinematics finds the command, and the nearest where the target is out of reach', () => {
  const {fk, ik} = exported(line, answersAt(1)), at = (u: number) => fk([u])?.outputs.slice(0, 3) ?? [];
  for (const found of [ik(0, at(1.62), [1]), ik('tip', at(1.62))]) {
    assert.ok(found?.reached);
    assert.ok(Math.abs(found.commands[0] - 1.62) < 1e-3);
  }
  const [x, y, z] = at(2), beyond = ik(0, [x, y + 3, z], [0.5]);
  assert.ok(beyond && !beyond.reached);
  let nearest = Infinity;
  for (let k = 0; k <= 20000; ++k) {
    const place = at(k / 10000);
    nearest = Math.min(nearest, Math.hypot(place[0] - x, place[1] - y - 3, place[2] - z));
  }
  assert.ok(Math.abs(beyond.errorMm - nearest) < 1e-4, `${beyond.errorMm}, not ${nearest}`);
  assert.equal(ik('tip', at(1), [2.5]), null);
  for (const marker of ['top', 1]) assert.throws(() => ik(marker, at(1)), RangeError);
});

test('an exported map notices that it does not answer as softkin does', () => {
  const answers = answersAt(0, 0.3, 1.7), told = (changed: Partial<MapAnswers>) =>
    exported(line, {...answers, ...changed}).check();
  assert.equal(told({}), '');
  const outputs = answers.outputs.map((row) => [...row]), slopes = answers.slopes.map((row) => [...row]);
  outputs[1][0] += 1e-10;
  slopes[2][3] += 1e-8;
  assert.match(told({outputs}), /^tip_x at \[0.3\] is /);
  assert.match(told({slopes}), /^slopes of air_pressure at \[1.7\]/);
  assert.match(told({commands: [[0], [3], [1.7]]}), /no answer at \[3\]/);
});

test('at the edge of a map less than the accuracy is not wrong', () => {
  const cables = [{input: 0, command: 1, tension: 3, ratio: 1}], tables = {...line.tables, pieces: [-1, 0], cables};
  const map = new KinematicMap({...line, tables});  // its tension is 6 (u - 1), its accuracy 0.01
  assert.ok(map.fk([1]) && map.fk([0.999]));
  assert.equal(map.fk([0.99]), null);
  const goals = [{output: 1, value: 2}];  // at 1.5
  assert.equal(map.lead(goals, [0.5]), null);
  assert.ok(map.lead(goals)?.reached);
});
