import assert from 'node:assert/strict';
import {test} from 'node:test';
import {boxAt, place, shared, type Box, type Wish} from '../src/labels';

const picture: Box = {left: 0, top: 0, right: 390, bottom: 400};
let state = 7;
const random = (): number => (state = (state * 1103515245 + 12345) % 2 ** 31) / 2 ** 31;

test('labels of markers anywhere on a phone never cover each other or what is there', () => {
  let placed = 0;
  for (let round = 0; round < 300; ++round) {
    const wishes: Wish[] = Array.from({length: 6}, () =>
      ({at: {x: 390 * random(), y: 400 * random()}, width: 30 + 60 * random(), height: 22}));
    const taken = [boxAt({x: 8, y: 8}, 370, 40), boxAt({x: 8, y: 330}, 150, 50)];
    const boxes = place(wishes, taken, picture, []).flatMap((at, i) =>
      at ? [boxAt(at, wishes[i].width, wishes[i].height)] : []);
    placed += boxes.length;
    boxes.forEach((box, i) => {
      assert.ok(box.left >= 0 && box.right <= 390 && box.top >= 0 && box.bottom <= 400);
      for (const other of [...boxes.slice(0, i), ...taken]) assert.equal(shared(box, other), 0);
    });
  }
  assert.ok(placed > 0.97 * 6 * 300, `only ${placed} of 1800 have a place`);
});

test('a label stays on its side while there is room', () => {
  const before: number[] = [], wish = (x: number): Wish[] => [{at: {x, y: 200}, width: 60, height: 20}];
  assert.deepEqual(place(wish(100), [], picture, before), [{x: 114, y: 208}]);
  assert.deepEqual(place(wish(350), [], picture, before), [{x: 276, y: 208}]);  // no room to the right
  assert.deepEqual(place(wish(200), [], picture, before), [{x: 126, y: 208}]);
});

test('what has no place at all is not shown', () => {
  assert.deepEqual(place([{at: {x: 5, y: 5}, width: 500, height: 20}], [], picture, []), [null]);
});
