import {digits} from './text';

/** Returns multiples of 1, 2 or 5 times a power of ten from low to high, as many as possible up to `maximum`. */
export function roundTicks(low: number, high: number, maximum: number): number[] {
  if (!(high > low) || !Number.isFinite(high - low)) return [low];
  const first = Math.floor(Math.log10((high - low) / maximum));
  for (let power = first; ; ++power) for (const factor of [1, 2, 5]) {
    // for negative powers the quotient is exact where the product is not
    const step = power < 0 ? factor / 10 ** -power : factor * 10 ** power, tolerance = 1e-9;
    const from = Math.ceil(low / step - tolerance), to = Math.floor(high / step + tolerance);
    if (to - from + 1 <= maximum)
      return Array.from({length: to - from + 1}, (_, i) =>
        power < 0 ? (from + i) * factor / 10 ** -power : (from + i) * step);
  }
}

/** Returns the ticks of a bar with their labels, fewer where the labels are long. */
export function labelledTicks(low: number, high: number): {value: number; label: string}[] {
  const maxCharacters = 24;
  for (let maximum = 6; ; --maximum) {
    const values = roundTicks(low, high, maximum);
    const step = values.length > 1 ? values[1] - values[0] : Math.abs(high - low);
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const largest = Math.max(...values.map(Math.abs), 0);
    const label = (value: number) => decimals > 4 || largest >= 1e6 ? digits(value, 2)
      : value.toFixed(decimals).replace('-', '−');
    const labels = values.map(label);
    if (maximum <= 3 || labels.join('').length <= maxCharacters)
      return values.map((value, i) => ({value, label: labels[i]}));
  }
}
