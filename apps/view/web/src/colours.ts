export type Rgb = [number, number, number];

// Cividis (Nunez, Anderton and Renslow 2018) at equal intervals: it looks alike with and without colour blindness.
const cividis: Rgb[] = [[0, 34, 78], [18, 53, 112], [59, 73, 108], [87, 93, 109], [112, 113, 115], [138, 134, 120],
                        [166, 157, 117], [197, 181, 102], [228, 207, 91], [254, 232, 56]];
// From blue through grey to orange, equally dark at both ends, for values on both sides of a middle value.
const diverging: Rgb[] = [[5, 72, 138], [68, 133, 194], [146, 190, 223], [225, 225, 225], [238, 176, 112],
                          [206, 111, 32], [138, 61, 5]];
// Okabe and Ito 2008.
const regions = ['#56b4e9', '#e69f00', '#009e73', '#cc79a7', '#f0e442', '#0072b2', '#d55e00', '#999999'];

// The part of each scale that contrasts with the background; on a dark one the darkest ends do not.
const onLight = {sequential: [0, 1], diverging: [0, 1]}, onDark = {sequential: [0.3, 1], diverging: [0.12, 0.88]};
let range = onLight;

export const regionColour = (i: number): string => regions[i % regions.length];

/** Returns the colour at a fraction from 0 to 1; other values are clamped. about: of the diverging scale. */
export function colourAt(fraction: number, about: boolean): Rgb {
  const colours = about ? diverging : cividis;
  const [from, to] = about ? range.diverging : range.sequential;
  const inside = Math.min(Math.max(Number.isFinite(fraction) ? fraction : 0, 0), 1);
  const x = (from + (to - from) * inside) * (colours.length - 1);
  const i = Math.min(Math.floor(x), colours.length - 2), f = x - i;
  return [0, 1, 2].map((k) => colours[i][k] + f * (colours[i + 1][k] - colours[i][k])) as Rgb;
}

export interface Scale { low: number; high: number; about: boolean }

/** Returns the scale that covers all values. about: the value in its middle, such as 1 of a volume ratio, or null. */
export function scaleOf(lists: ArrayLike<number>[], about: number | null, fromZero: boolean): Scale {
  let low = fromZero ? 0 : Infinity, high = -Infinity;
  for (const values of lists)
    for (let i = 0; i < values.length; ++i) {
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
  if (!(high > low)) high = (low = Number.isFinite(low) ? low : 0) + 1e-6;
  if (about === null) return {low, high, about: false};
  const reach = Math.max(high - about, about - low);
  return {low: about - reach, high: about + reach, about: true};
}

/** Converts an sRGB component from 0 to 255 to linear light, which shaders use. */
const linear = (c: number): number => {
  const s = c / 255;
  return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4;
};

const steps = 256;
const makeTables = (): Float32Array[] => [false, true].map((about) => {
  const table = new Float32Array(3 * steps);
  for (let i = 0; i < steps; ++i) colourAt(i / (steps - 1), about).forEach((c, k) => { table[3 * i + k] = linear(c); });
  return table;
});
let tables = makeTables();

/** Selects the colours for a dark or a light background. */
export function colourFor(dark: boolean): void {
  range = dark ? onDark : onLight;
  tables = makeTables();
}

/** Writes the colours of the values into `to`, three numbers each. */
export function paint(values: ArrayLike<number>, {low, high, about}: Scale, to: Float32Array): void {
  const table = tables[about ? 1 : 0], factor = (steps - 1) / (high - low);
  for (let i = 0; i < values.length; ++i) {
    const index = 3 * Math.round(Math.min(Math.max((values[i] - low) * factor, 0), steps - 1) || 0);
    to[3 * i] = table[index];
    to[3 * i + 1] = table[index + 1];
    to[3 * i + 2] = table[index + 2];
  }
}
