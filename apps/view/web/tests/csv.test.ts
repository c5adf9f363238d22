import assert from 'node:assert/strict';
import {test} from 'node:test';
import {PathError, readPath} from '../src/csv';
import type {Actuator, Marker} from '../src/document';

const actuator = (name: string, unit: string, low: number, high: number, rest: number): Actuator =>
  ({name, unit, low, high, rest, kind: 'pneumatic', control: unit ? 'pressure' : 'volume', load_unit: 'kPa', measure_unit: ''});
const actuators = [actuator('air', '', 1, 2, 1), actuator('left.air', 'kPa', 0, 50, 0)];
const tip: Marker = {name: 'tip', at: [0, 0, 0]}, side: Marker = {name: 'side_x', at: [0, 0, 0]};
const read = (text: string, markers = [tip]) => readPath(text, actuators, markers);
const refused = (text: string, what: RegExp, markers = [tip]) =>
  assert.throws(() => read(text, markers), (error) => error instanceof PathError && what.test(error.message));

test('columns of actuators are commands; others rest', () => {
  assert.deepEqual(read('\uFEFF# made by hand\r\n\r\nt_s, air\r\n0,1\r\n0.5, 1.25\r\n'),
                   {kind: 'commands', rows: [[1, 0], [1.25, 0]], lines: [4, 5], times: [0, 0.5]});
  assert.deepEqual(read('left.air_kPa,air\n20,1.5'), {kind: 'commands', rows: [[1.5, 20]], lines: [2], times: null});
});

test('a unit of several words is one in the name of a column', () => {
  const magnet = actuator('magnet', 'A m^2', -1, 1, 0);
  assert.deepEqual(readPath('magnet_Am2\n0.5', [magnet], [tip]).rows, [[0.5]]);
  assert.throws(() => readPath('wind\n1', [magnet], [tip]), /this robot has magnet_Am2/);
});

test('coordinates are waypoints; those without column do not count', () => {
  assert.deepEqual(read('x_mm,z_mm\n1,-2e1\n'),
                   {kind: 'waypoints', rows: [[{marker: 0, at: [1, null, -20]}]], lines: [2], times: null});
  assert.deepEqual(read('tip_y_mm,side_x_x_mm\n1,2', [tip, side]).rows,
                   [[{marker: 0, at: [null, 1, null]}, {marker: 1, at: [2, null, null]}]]);
});

test('what is wrong is said with its line and column', () => {
  refused('', /empty/);
  refused('1,2\n3,4', /^Line 1: .*named/);
  refused('air;left.air\n1;2', /^Line 1: .*commas/);
  refused('air', /^Line 1: no row/);
  refused('air,air\n1,1', /^Line 1: column air appears twice/);
  refused('air,\n1,1', /^Line 1: column 2 has no name/);
  refused('air\n1\n\n1,2', /^Line 4: it has 2 cells, but there are 1 columns/);
  refused('air\nmuch', /^Line 2: column air must hold a number, not "much"/);
  refused('air\n1\n2.5', /^Line 3: column air: 2.5 is outside its range, 1 to 2/);
  refused('left.air\n60', /^Line 2: column left.air: 60 is outside its range, 0 to 50 kPa/);
  refused('wind,air\n1,1', /^Line 1: column wind names no actuator; this robot has air, left.air_kPa/);
  refused('left.air,left.air_kPa\n1,1', /another column is of that actuator/);
  refused('t_s\n1', /^Line 1: no column names/);
  refused('t_s,air\n1,1\n1,1', /^Line 3: column t_s must grow/);
  refused('x_mm\n1', /^Line 1: column x_mm: of which marker\? Write tip_x_mm, side_x_x_mm/, [tip, side]);
  refused('toe_x_mm\n1', /^Line 1: column toe_x_mm: there is no marker toe/);
  refused('x\n1', /^Line 1: column x lacks its unit: x_mm/);
  refused('x_mm,speed\n1,1', /^Line 1: column speed is no coordinate/);
});
