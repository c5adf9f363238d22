import assert from 'node:assert/strict';
import {test} from 'node:test';
import type {Actuator, RobotDocument} from '../src/document';
import type {MapDocument} from '../src/map';
import {Robot} from '../src/robot';

const packed = (...values: number[]) => Buffer.from(Float64Array.from(values).buffer).toString('base64');

const actuator = (name: string, more: Partial<Actuator>): Actuator =>
  ({name, kind: 'pneumatic', control: 'pressure', unit: 'kPa', low: 0, high: 2, rest: 0, load_unit: '× rest',
    measure_unit: '', ...more});
/** A name that is the beginning of another one; volumes of commanded pressures; a cable by tension, one by length. */
const actuators = [
  actuator('air_2', {}), actuator('air', {}),
  actuator('pull', {kind: 'cable', control: 'tension', unit: 'N', load_unit: 'N', measure_unit: '× rest'}),
  actuator('tendon', {kind: 'cable', control: 'length', unit: '', load_unit: 'N', measure_unit: '× rest'}),
];
const names = ['tip_x', 'tip_y', 'tip_z', 'air_2_ratio', 'air_ratio', 'pull_ratio', 'tendon_tension', 'tendon_ratio'];
/** Of the first input alone, from 0 to 2: output q is q + 1 + x / 10, x from -1 to 1. */
const map: MapDocument = {
  name: 'made up', markers: ['tip'],
  inputs: actuators.map(({name, unit, low, high}) => ({name, unit, low, high})),
  outputs: names.map((name) => ({name, unit: '', accuracy: 1, largestError: 1, meanError: 1})),
  checked: {points: 1, outside: 0, equilibria: 3},
  tables: {
    pieces: [0], variables: [[0]], roots: [0], nodes: [[0]], cables: [], boxes: [[[0, 2]]],
    outputs: {size: 8, highest: [1], cells: [0, 1], terms: [0, 2], runs: [2],
              coefficients: packed(...names.map((_, q) => q + 1), ...names.map(() => 0.1))},
    modes: {size: 1, highest: [0], cells: [0, 1], terms: [0, 1], runs: [1], coefficients: packed(0)},
  },
  shapeTables: {mean: Buffer.from(Float32Array.of(0, 0, 0).buffer).toString('base64'), units: [1],
                modes: Buffer.from(Int16Array.of(0, 0, 0).buffer).toString('base64')},
};

test('every output of the map is shown with the map, by its exact name', () => {
  const document = {actuators, map, markers: [{name: 'tip', at: [0, 0, 0]}], rest: new Float32Array(3), steps: [],
                    live: null} as unknown as RobotDocument;
  const robot = new Robot(document);
  for (const command of [0, 0.5, 1.7]) {
    const x = 0.1 * (command - 1), near = (a: (number | null)[], b: (number | null)[]) =>
      a.forEach((value, i) => assert.ok(value === b[i] || Math.abs((value ?? NaN) - (b[i] ?? NaN)) < 1e-12, `${a} ${b}`));
    robot.command([command, 0, 1.25, 1]);
    near(robot.pose.markers[0], [1 + x, 2 + x, 3 + x]);
    near(robot.pose.loads, [4 + x, 5 + x, 1.25, 7 + x]);
    near(robot.pose.measures, [null, null, 6 + x, 8 + x]);
  }
});
