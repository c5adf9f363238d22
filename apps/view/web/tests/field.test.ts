import assert from 'node:assert/strict';
import {test} from 'node:test';
import type {Actuator} from '../src/document';
import {draggedField, fieldOf, largestField} from '../src/field';

const along = (direction: number[], low = -10, high = 10): Actuator =>
  ({name: 'field', kind: 'magnetic', control: 'flux density', unit: 'mT', low, high, rest: 0, load_unit: '', measure_unit: '',
    flux_density: direction});
const cable: Actuator =
  {name: 'tendon', kind: 'cable', control: 'length', unit: '', low: 0.5, high: 1, rest: 1, load_unit: 'N', measure_unit: ''};
const [x, y, z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const near = (found: number[], wanted: number[]) =>
  assert.ok(found.every((value, k) => Math.abs(value - wanted[k]) < 1e-9), `${found} is not ${wanted}`);

test('the field is the sum of all uniform fields', () => {
  const actuators = [along([0.6, 0, 0.8]), cable, along(x)];
  near(fieldOf(actuators, [5, 0.7, -1]), [2, 0, 4]);
  near(fieldOf(actuators, [NaN, NaN, 2]), [2, 0, 0]);
  near(largestField([along(x, -1, 3), along([0.6, 0, 0.8])]) ?? [], [9, 0, 8]);
  assert.equal(largestField([cable]), null);
  assert.equal(largestField([along(z, 0, 0)]), null);
});

test('one field follows a drag as far as it is seen, whatever the way of the eye', () => {
  const eye = [0, 0.6, 0.8];  // sees 0.6 of z
  near(draggedField([along(z)], [1], [0, -0.48 * 3, 0.36 * 3], eye), [4]);
  near(draggedField([along(z)], [1], [5, 0, 0], eye), [1]);  // beside its direction
  near(draggedField([along(z)], [1], [0, -480, 360], eye), [10]);
  near(draggedField([along(y), cable], [1, 0.7], [0, 0, 3], y), [1, 0.7]);  // which points at the eye
});

test('fields along several directions lead the tip to where it is dragged', () => {
  const actuators = [along(x), cable, along(z)], eye = [0.48, 0.6, 0.64], start = [2, 0.7, -1], wanted = [-3, 0.7, 4];
  const across = (at: number[]) => at.map((value, k) =>
    value - (at[0] * eye[0] + at[1] * eye[1] + at[2] * eye[2]) * eye[k]);
  near(draggedField(actuators, start, across([-5, 0, 5]), eye), wanted);
  const all = [along(x), along(y), along(z)], change = across([1, 2, 3]);
  near(draggedField(all, [0, 0, 0], change, eye), change);  // the least change of all that are seen alike
});

test('commands stay in their ranges, and the others make up for it as they can', () => {
  const actuators = [along(x, -1, 1), along([Math.SQRT1_2, 0, Math.SQRT1_2], -9, 9)];
  const [first, second] = draggedField(actuators, [0, 0], [4, 0, 0], y);
  assert.equal(first, 1);
  near([second], [3 * Math.SQRT1_2]);  // nearest to what is left, 3 along x
});
