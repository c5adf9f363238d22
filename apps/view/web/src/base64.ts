export type PackedKind = 'f32' | 'f64' | 'u32' | 'u16' | 'i16';
/** An array of little-endian numbers as base64: {"f32": "..."}. With low and step, which repeat over the numbers n,
    the values are low + step n: {"u16": "...", "low": [x, y, z], "step": [x, y, z]}. */
export type Packed = {[kind in PackedKind]?: string} & {low?: number[]; step?: number[]};

export function bytesOf(text: string): Uint8Array {
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

const littleEndian = new Uint8Array(new Uint16Array([1]).buffer)[0] === 1;

/** Decodes little-endian numbers into this machine's byte order. */
function decodeNumbers(text: string, size: number): ArrayBuffer {
  const bytes = bytesOf(text);
  if (bytes.length % size !== 0)
    throw new RangeError(`${bytes.length} bytes are not a multiple of ${size}, the bytes of a number`);
  if (!littleEndian) for (let i = 0; i < bytes.length; i += size) bytes.subarray(i, i + size).reverse();
  return bytes.buffer as ArrayBuffer;
}

export const float32 = (text: string): Float32Array => new Float32Array(decodeNumbers(text, 4));
export const float64 = (text: string): Float64Array => new Float64Array(decodeNumbers(text, 8));
export const int16 = (text: string): Int16Array => new Int16Array(decodeNumbers(text, 2));

export type Numbers = Float32Array | Float64Array | Uint32Array | Uint16Array | Int16Array;

export function unpack(packed: Packed): Numbers {
  const {low, step} = packed;
  if (!low || !step) return unpackUnscaled(packed);
  if (!low.length || low.length !== step.length)
    throw new RangeError('low and step of an array are empty or differ in length');
  return Float64Array.from(unpackUnscaled(packed), (n, i) => low[i % low.length] + step[i % low.length] * n);
}

function unpackUnscaled(packed: Packed): Numbers {
  if (packed.f32 !== undefined) return float32(packed.f32);
  if (packed.f64 !== undefined) return float64(packed.f64);
  if (packed.u32 !== undefined) return new Uint32Array(decodeNumbers(packed.u32, 4));
  if (packed.u16 !== undefined) return new Uint16Array(decodeNumbers(packed.u16, 2));
  if (packed.i16 !== undefined) return int16(packed.i16);
  throw new TypeError('an array has none of the types f32, f64, u32, u16 and i16');
}
