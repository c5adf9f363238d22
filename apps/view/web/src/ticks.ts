import {digits} from './text';

/** Multiples of 1, 2 or 5 times a power of ten from low to high: as many as may be, at most `most`. */
export function roundTicks(low: number, high: number, most: number): number[] {
  if (!(high > low) || !Number.isFinite(high - low)) return [low];
  const first = Math.floor(Math.log10((high - low) / most));
  for (let power = first; ; ++power) for (const factor of [1, 2, 5]) {
    // of negative powers the quotient is exact where the product is not
    const step = power < 0 ? factor / 10 ** -power : factor * 10 ** power, slack = 1e-9;
    const from = Math.ceil(low / step - slack), to = Math.floor(high / step + slack);
    if (to - from + 1 <= most)
      return Array.from({length: to - from + 1}, (_, i) =>
        power < 0 ? (from + i) * factor / 10 ** -power : (from + i) * step);
  }
}

/** Ticks of a bar with their labels: fewer where labels are long. */
export function labelledTicks(low: number, high: number): {value: number; label: string}[] {
  const mostCharacters = 24;
  for (let most = 6; ; --most) {
    const values = roundTicks(low, high, most), step = values.length > 1 ? values[1] - values[0] : Math.abs(high - low);
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const largest = Math.max(...values.map(Math.abs), 0);
    const label = (value: number) => decimals > 4 || largest >= 1e6 ? digits(value, 2)
      : value.toFixed(decimals).replace('-', '−');
    const labels = values.map(label);
    if (most <= 3 || labels.join('').length <= mostCharacters)
      return values.map((value, i) => ({value, label: labels[i]}));
  }
}
