import type {SolverReport} from './document';
import type {Estimate} from './estimate';

/** The server's result for the target of a marker. */
export interface FrameTarget { marker: number; at: number[]; error_mm: number | null; reached: boolean; why: string }
interface Head extends SolverReport {
  id: number; commands: (number | null)[]; loads: (number | null)[]; measures: (number | null)[];
  markers: (number | null)[][];
  target: FrameTarget | null; arrays: string[]; vertices: number; estimate?: Estimate;
}
/** A shape of softkin view; unknown numbers are NaN. */
export interface Frame extends Omit<Head, 'arrays' | 'vertices' | 'commands' | 'markers'> {
  commands: number[]; markers: number[][]; positions: Float32Array; fields: Record<string, Float32Array>;
}

/** Reads a shape of softkin view: uint32 length of the head, the head as JSON, then float32 positions and arrays, all
    little-endian. Throws where the data are malformed or the number of vertices differs. */
export function readFrame(data: ArrayBuffer, vertices: number): Frame {
  const view = new DataView(data);
  if (data.byteLength < 4) throw new RangeError('a shape has no head');
  const length = view.getUint32(0, true), begin = 4 + length;
  if (begin > data.byteLength) throw new RangeError('the head of a shape is longer than its message');
  const text = new TextDecoder('utf-8', {fatal: true}).decode(new Uint8Array(data, 4, length));
  const {arrays, vertices: count, commands, markers, ...head} = JSON.parse(text) as Head;
  if (count !== vertices) throw new RangeError(`a shape has ${count} vertices, not ${vertices}`);
  if (data.byteLength !== begin + 4 * count * (3 + arrays.length))
    throw new RangeError('the length of a shape does not match its head');
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
