import assert from 'node:assert/strict';
import {existsSync, readFileSync} from 'node:fs';
import {test} from 'node:test';
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

test('inverse kinematics finds the command, and the nearest where the target is out of reach', () => {
  const map = new KinematicMap(line), at = (u: number) => map.fk([u])?.outputs.slice(0, 3) ?? [];
  const found = map.ik(0, at(1.62), [1]);
  assert.ok(found?.reached);
  assert.ok(Math.abs(found.commands[0] - 1.62) < 1e-3);
  const [x, y, z] = at(2), beyond = map.ik(0, [x, y + 3, z], [0.5]);
  assert.ok(beyond && !beyond.reached);
  let nearest = Infinity;
  for (let k = 0; k <= 20000; ++k) {
    const place = at(k / 10000);
    nearest = Math.min(nearest, Math.hypot(place[0] - x, place[1] - y - 3, place[2] - z));
  }
  assert.ok(Math.abs(beyond.errorMm - nearest) < 1e-4, `${beyond.errorMm}, not ${nearest}`);
});

/** SOFTKIN_MAP_MODULE: what `softkin map export --js` wrote, with answers of softkin in it. */
const file = process.env.SOFTKIN_MAP_MODULE ?? '';
test('answers of an exported module are met', {skip: !existsSync(file)}, async () => {
  const text = readFileSync(file, 'utf8');
  const constant = (name: string) => {
    const found = new RegExp(`const ${name} = (.*);\n`).exec(text);
    return found ? JSON.parse(found[1]) : null;
  };
  const names = ['name', 'inputs', 'outputs', 'markers', 'checked', 'tables', 'shapeTables'];
  const document = Object.fromEntries(names.map((name) => [name, constant(name)])) as unknown as MapDocument;
  const map = new KinematicMap(document);
  const module = await import(file), answers = constant('answers');
  assert.ok(answers.commands.length > 0);
  answers.commands.forEach((commands: number[], n: number) => {
    const found = map.fk(commands);
    assert.ok(found);
    found.outputs.forEach((value, q) => {
      assert.ok(Math.abs(value - answers.outputs[n][q]) <= 1e-12 * answers.outputScale[q], map.outputs[q].name);
      const slope = map.inputs.reduce((sum, {low, high}, i) => sum + found.jacobian[q][i] * (i + 1) * (high - low), 0);
      assert.ok(Math.abs(slope - answers.slopes[n][q]) <= 1e-10 * answers.slopeScale[q]);
    });
    if (module.shape) assert.deepEqual(map.shape(commands), module.shape(commands));
    const target = found.outputs.slice(0, 3).map((x) => x + 0.5);
    const middle = map.inputs.map(({low, high}) => low + (high - low) / 2);
    assert.deepEqual(map.ik(0, target, middle), module.ik(0, target, middle));
  });
});

test('at the edge of a map less than the accuracy is not wrong', () => {
  const cables = [{input: 0, command: 1, tension: 3, ratio: 1}], tables = {...line.tables, pieces: [-1, 0], cables};
  const map = new KinematicMap({...line, tables});  // its tension is 6 (u - 1), its accuracy 0.01
  assert.ok(map.fk([1]) && map.fk([0.999]));
  assert.equal(map.fk([0.99]), null);
});
