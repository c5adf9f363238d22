/** Where something is on the picture [px]. */
export interface Spot { x: number; y: number }
export interface Box { left: number; top: number; right: number; bottom: number }

export const boxAt = ({x, y}: Spot, width: number, height: number): Box =>
  ({left: x, top: y, right: x + width, bottom: y + height});

/** Of what two boxes share [px²]. */
export function shared(a: Box, b: Box): number {
  const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
  const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
  return width > 0 && height > 0 ? width * height : 0;
}

/** What a label names, and how large it is. */
export interface Wish { at: Spot; width: number; height: number }

/** Steps away from what is named, in the order in which they are tried; the last ones for crowds. */
const steps = [1, 2, 3.5, 5.5];

function placesFor({at: {x, y}, width, height}: Wish): Spot[] {
  return steps.flatMap((far) => {
    const right = x + 14 * far, left = x - 14 * far - width, below = y + 8 * far, above = y - 8 * far - height;
    return [{x: right, y: below}, {x: right, y: above}, {x: left, y: below}, {x: left, y: above},
            {x: x - width / 2, y: below + 8 * far}, {x: x - width / 2, y: above - 8 * far}];
  });
}

/** Places for labels so that none covers another, what is taken already, or leaves the picture; null: there is none.
    before: the choice of each the last time, which it keeps where it can, and is told of the new one. */
export function place(wishes: Wish[], taken: Box[], picture: Box, before: number[]): (Spot | null)[] {
  const full = taken.slice();
  return wishes.map((wish, i) => {
    const places = placesFor(wish), order = [before[i] ?? 0, ...places.keys()];
    const fits = (at: Spot): boolean => {
      const box = boxAt(at, wish.width, wish.height);
      return box.left >= picture.left && box.right <= picture.right && box.top >= picture.top &&
        box.bottom <= picture.bottom && full.every((other) => shared(box, other) === 0);
    };
    const chosen = order.find((k) => fits(places[k]));
    if (chosen === undefined) return null;
    before[i] = chosen;
    full.push(boxAt(places[chosen], wish.width, wish.height));
    return places[chosen];
  });
}
