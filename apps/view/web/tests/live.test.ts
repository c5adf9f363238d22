import assert from 'node:assert/strict';
import {afterEach, beforeEach, test} from 'node:test';
import {type Frame, readFrame} from '../src/frame';
import {Live, type LiveState} from '../src/live';
import {FakeClock} from './fake_clock';

/** A shape of softkin view: the head padded with spaces, positions, then the arrays. */
function shape(head: object, ...floats: number[]): ArrayBuffer {
  const text = JSON.stringify(head), length = text.length + (4 - text.length % 4) % 4;
  const data = Buffer.alloc(4 + length + 4 * floats.length, ' ');
  data.writeUInt32LE(length, 0);
  data.write(text, 4);
  floats.forEach((value, i) => data.writeFloatLE(value, 4 + length + 4 * i));
  return data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength) as ArrayBuffer;
}

const headOf = (id: number, more: object = {}) => ({id, status: 'converged', remark: '', commands: [1], loads: [null],
  markers: [[1, 2, 3]], iterations: 2, seconds: 0.1, target: null, arrays: ['strain'], vertices: 1, ...more});

test('a shape is its head, its positions and its arrays', () => {
  const frame = readFrame(shape(headOf(7, {arrays: ['strain', 'more']}), 1, 2, -3, 0.5, 0.25), 1);
  assert.deepEqual([...frame.positions], [1, 2, -3]);
  assert.deepEqual([[...frame.fields.strain], [...frame.fields.more]], [[0.5], [0.25]]);
  assert.equal(frame.id, 7);
  assert.throws(() => readFrame(shape(headOf(7), 1, 2, -3), 1), RangeError);
  assert.throws(() => readFrame(shape(headOf(7), 1, 2, -3, 0.5), 2), RangeError);
  assert.throws(() => readFrame(new ArrayBuffer(2), 1), RangeError);
});

class FakeSocket {
  static readonly OPEN = 1;
  static all: FakeSocket[] = [];
  readonly sent: Record<string, unknown>[] = [];
  readyState = 0;
  private readonly listeners: Record<string, ((event: object) => void)[]> = {};

  constructor(readonly url: string) { FakeSocket.all.push(this); }

  addEventListener(name: string, act: (event: object) => void): void { (this.listeners[name] ??= []).push(act); }

  send(text: string): void { this.sent.push(JSON.parse(text)); }

  happen(name: string, event: object = {}): void { for (const act of this.listeners[name] ?? []) act(event); }

  open(state: object = {}): void {
    this.readyState = 1;
    this.happen('open');
    this.hear({type: 'state', model: 'abc', secret: true, control: true, free: false, watchers: 0, ...state});
  }

  hear(message: object): void { this.happen('message', {data: JSON.stringify(message)}); }

  answer(id: unknown): void { this.happen('message', {data: shape(headOf(id as number), 1, 2, 3, 0)}); }
}

const clock = new FakeClock();
let states: LiveState[] = [], frames: [number, boolean, boolean][] = [], reloads = 0,
  maps: unknown[] = [];
const start = (): {live: Live; socket: FakeSocket} => {
  const live = new Live('ws://here/live', 'secret', 'abc', 1, {
    onFrame: (frame: Frame, mine, newest) => { frames.push([frame.id, mine, newest]); },
    onState: (state) => { states.push(state); },
    onOtherModel: () => { ++reloads; },
    onMap: (map) => { maps.push(map); },
  });
  live.connect();
  return {live, socket: FakeSocket.all[0]};
};

beforeEach(() => {
  clock.install();
  Object.assign(globalThis, {WebSocket: FakeSocket, window: globalThis});
  [FakeSocket.all, states, frames, reloads, maps] = [[], [], [], 0, []];
});
afterEach(() => clock.uninstall());

test('a map that was made meanwhile is taken', () => {
  const {socket} = start();
  socket.open();
  socket.hear({type: 'map', map: {inputs: []}});
  assert.deepEqual(maps, [{inputs: []}]);
});

test('one request is on its way, and the newest waits', () => {
  const {live, socket} = start();
  socket.open();
  assert.deepEqual(socket.sent as unknown, [{type: 'hello', secret: 'secret'}]);
  const ids = [1, 2, 3].map((command) => live.send({type: 'command', commands: [command]}));
  assert.ok(ids[0] < ids[1] && ids[1] < ids[2] && ids[2] <= 2 ** 53);
  clock.tick(5000);
  assert.deepEqual(socket.sent.slice(1).map(({id}) => id), [ids[0]]);
  socket.answer(ids[0]);
  assert.deepEqual(socket.sent.slice(1).map(({id, commands}) => [id, commands]), [[ids[0], [1]], [ids[2], [3]]]);
  assert.ok(live.busy);
  socket.answer(ids[2]);
  assert.ok(!live.busy);
  assert.deepEqual(frames, [[ids[0], true, false], [ids[2], true, true]]);
});

test('a search for a target gives way after a second', () => {
  const {live, socket} = start();
  socket.open();
  const first = live.send({type: 'target', marker: 0, at: [1, 2, 3]});
  const second = live.send({type: 'target', marker: 0, at: [1, 2, 4]});
  assert.equal(socket.sent.length, 2);
  clock.tick(1100);
  assert.deepEqual(socket.sent.slice(1).map(({id}) => id), [first, second]);
  socket.answer(first);
  assert.ok(live.busy);
  socket.answer(second);
  assert.deepEqual(frames, [[first, false, false], [second, true, true]]);
});

test('what is refused is told, and the next request goes out', () => {
  const {live, socket} = start();
  socket.open();
  const first = live.send({type: 'command', commands: [1]}), second = live.send({type: 'command', commands: [2]});
  socket.hear({type: 'refused', id: first, why: 'too much'});
  assert.equal(states.at(-1)?.refused, 'too much');
  assert.equal(socket.sent.at(-1)?.id, second);
  socket.answer(second);
  assert.equal(states.at(-1)?.refused, '');
});

test('without control nothing is asked', () => {
  const {live, socket} = start();
  socket.open({control: false, free: true});
  live.send({type: 'command', commands: [1]});
  assert.deepEqual(socket.sent.map(({type}) => type), ['hello']);
  assert.ok(live.busy);
  socket.hear({type: 'state', model: 'abc', secret: true, control: false, free: false, watchers: 0});
  assert.ok(!live.busy, 'what was asked is not forgotten');
  live.take();
  assert.deepEqual(socket.sent.at(-1), {type: 'take'});
});

test('it connects again, with longer pauses, and forgets what it asked', () => {
  const {live, socket} = start();
  socket.open();
  live.send({type: 'command', commands: [1]});
  socket.happen('close');
  assert.ok(!states.at(-1)?.connected && !live.busy);
  for (const [n, pause] of [500, 1000, 2000, 4000, 5000, 5000].entries()) {
    clock.tick(pause - 1);
    assert.equal(FakeSocket.all.length, n + 1);
    clock.tick(1);
    assert.equal(FakeSocket.all.length, n + 2);
    FakeSocket.all[n + 1].happen('close');
  }
  clock.tick(5000);
  FakeSocket.all[7].open();
  assert.ok(states.at(-1)?.connected);
  FakeSocket.all[7].hear({type: 'state', model: 'other', secret: true, control: true, free: false, watchers: 0});
  assert.equal(reloads, 1);
});
