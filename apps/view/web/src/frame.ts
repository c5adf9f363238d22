import type {Told} from './document';
import type {Estimate} from './estimate';

/** What the server says of where a marker was to go. */
export interface FrameTarget { marker: number; at: number[]; error_mm: number | null; reached: boolean; why: string }
interface Head extends Told {
  id: number; commands: (number | null)[]; loads: (number | null)[]; measures: (number | null)[];
  markers: (number | null)[][];
  target: FrameTarget | null; arrays: string[]; vertices: number; estimate?: Estimate;
}
/** Numbers that the program does not know are NaN. */
export interface Frame extends Omit<Head, 'arrays' | 'vertices' | 'commands' | 'markers'> {
  commands: number[]; markers: number[][]; positions: Float32Array; fields: Record<string, Float32Array>;
}

/** One shape of softkin view: uint32 length of the head, the head as JSON, then float32 positions and arrays, all
    little-endian. Throws where it is none, or has another number of vertices. */
export function readFrame(data: ArrayBuffer, vertices: number): Frame {
  const view = new DataView(data);
  if (data.byteLength < 4) throw new RangeError('a shape without head');
  const length = view.getUint32(0, true), begin = 4 + length;
  if (begin > data.byteLength) throw new RangeError('a shape whose head is longer than it');
  const text = new TextDecoder('utf-8', {fatal: true}).decode(new Uint8Array(data, 4, length));
  const {arrays, vertices: count, commands, markers, ...head} = JSON.parse(text) as Head;
  if (count !== vertices) throw new RangeError(`a shape of ${count} vertices, not ${vertices}`);
  if (data.byteLength !== begin + 4 * count * (3 + arrays.length)) throw new RangeError('a shape of another length');
  const floats = (first: number, size: number): Float32Array => {
    const values = new Float32Array(size);
    for (let i = 0; i < size; ++i) values[i] = view.getFloat32(first + 4 * i, true);
    return values;
  };
  const fields: Record<string, Float32Array> = {};
  arrays.forEach((name, a) => { fields[name] = floats(begin + 4 * count * (3 + a), count); });
  return {...head, commands: commands.map((value) => value ?? NaN),
          markers: markers.map((at) => at.map((value) => value ?? NaN)), positions: floats(begin, 3 * count), fields};
}
