/** Formats a number with significant digits, without a power of ten for usual magnitudes. */
export function digits(value: number | null | undefined, count = 4): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (Math.abs(value) < 1e-9) return '0';
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 6) return value.toExponential(count - 1).replaceAll('-', '−');
  return value.toFixed(Math.max(0, count - 1 - size)).replace('-', '−');
}

/** Formats a coordinate in mm. */
export const mm = (value: number): string => (Math.abs(value) < 0.005 ? 0 : value).toFixed(2).replace('-', '−');

export const withUnit = (value: string, unit: string): string => unit ? `${value} ${unit}` : value;

export const plain = (name: string): string => name.replaceAll('_', ' ');

type Child = Node | string;
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Record<string, string | number> = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.append(...children);
  return made;
}

export function byId<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element ${id}`);
  return found as T;
}
