import assert from 'node:assert/strict';
import {test} from 'node:test';
import {fitText, forceText, halfOpening, placeText, plusMinus, type EstimatedForce} from '../src/estimate';
import {roundBelow} from '../src/forces';
import {lineOf} from '../src/command_line';
import type {Actuator, RobotDocument} from '../src/document';
import {groupsOf, readingsCsv, unitOf, whyNoReading} from '../src/readings';
import type {Robot} from '../src/robot';

const force: EstimatedForce = {name: 'touch', at_mm: [1, 2, 3], force_N: [0, 3, -4], deviation_N: 0.25,
                          across_N: [[5, 0, 0], [0, 0.8, 0.6]], place_mm: null};

test('numbers have as many decimals as their deviations tell', () => {
  assert.equal(plusMinus(-0.42713, 0.0981, 'N'), '−0.427 ± 0.098 N');
  assert.equal(plusMinus(93.2, 11.4, ''), '93 ± 11');
  assert.equal(plusMinus(2, 0, 'mm'), '2.000 mm');
});

test('the cone is as wide as its longer half axis over the force', () => {
  assert.ok(Math.abs(halfOpening(force) - 45) < 1e-9);
  assert.equal(halfOpening({...force, across_N: [[0, 0, 0], [0, 0, 0]]}), 0);
  assert.ok(Math.abs(halfOpening({...force, force_N: [0, 0, 0]}) - 90) < 1e-9);
  assert.equal(forceText(force), 'touch: 5.00 ± 0.25 N; its direction within 45° (90 %)');
});

test('places and fits are told', () => {
  const covariance = [[4, 0, 0], [0, 0.01, 0], [0, 0, 0]];
  assert.equal(placeText({force: 'touch', at_rest_mm: [90, -2, 0], present_mm: [0, 0, 0], covariance_mm2: covariance}),
               'x 90.0 ± 2.0, y −2.00 ± 0.10, z 0 mm');
  const told = {status: 'converged', remark: '', chi_square: 5.5, freedoms: 8, misfit: -0.5};
  assert.match(fitText(told), /^Chi-square 5\.50 for 8\.00 freedoms: the readings fit the model\.$/);
  assert.match(fitText({...told, misfit: 3.1}), /do not fit/);
  assert.equal(fitText({status: 'not converged', remark: 'why'}), '');
});

test('scales are 1, 2 or 5 times a power of ten', () => {
  assert.deepEqual([1, 1.9, 2, 4.99, 5, 9, 0.031, 310].map(roundBelow), [1, 1, 2, 2, 5, 5, 0.02, 200]);
});

test('what was typed is saved as a table of softkin estimate', () => {
  const column = (name: string) => ({name, group: name, axis: '', unit: 'mm', deviation: 1});
  const document = {
    command: 'softkin view a.yaml --unknown touch:place --deviation=0.2 --fade 2 --port 8123 --keep-all --stable',
    actuators: [{name: 'air'}, {name: 'touch_fx'}],
    live: {estimate: {columns: [column('m1_x_mm'), column('m1_y_mm')], told: [1], fade_s: 2}},
  } as unknown as RobotDocument;
  assert.equal(readingsCsv({document, commands: [10, 0.3], values: [36.5, null]} as unknown as Robot),
               'air,m1_x_mm\n10,36.5\n');
  assert.equal(lineOf(document, [10, 0.3]),
               'softkin estimate a.yaml readings.csv --unknown touch:place --deviation=0.2 --keep-all --stable');
});

test('what is told of a ratio has its unit in words', () => {
  const actuators = [{name: 'tendon', unit: '', control: 'length'}, {name: 'air', unit: 'kPa'}] as Actuator[];
  const told = {value: 1, deviation: 0.1};
  assert.equal(unitOf({...told, name: 'tendon', unit: ''}, actuators), '× rest length');
  assert.equal(unitOf({...told, name: 'air', unit: 'kPa'}, actuators), 'kPa');
});

test('what is typed is a number or nothing', () => {
  const column = {name: 'm1_x_mm', group: 'marker m1', axis: 'x', unit: 'mm', deviation: 0.2};
  assert.deepEqual(['', ' ', '-3.5', '1e9'].map((text) => whyNoReading(text, column)), ['', '', '', '']);
  assert.match(whyNoReading('12,5', column), /^m1 x mm: type a number/);
  assert.match(whyNoReading('1e10', column), /a number up to 1000000000/);
  const strain = {...column, name: 'strain_length_mm', group: 'strain_length_mm', axis: ''};
  assert.deepEqual([...groupsOf([column, strain, {...column, axis: 'z'}])],
                   [['marker m1', [0, 2]], ['strain_length_mm', [1]]]);
});
