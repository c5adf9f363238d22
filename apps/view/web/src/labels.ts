/** A position on the picture [px]. */
export interface Spot { x: number; y: number }
export interface Box { left: number; top: number; right: number; bottom: number }

export const boxAt = ({x, y}: Spot, width: number, height: number): Box =>
  ({left: x, top: y, right: x + width, bottom: y + height});

/** Returns the area of the overlap of two boxes [px²]. */
export function shared(a: Box, b: Box): number {
  const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
  const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
  return width > 0 && height > 0 ? width * height : 0;
}

/** The position of the labelled point, and the size of its label. */
export interface Wish { at: Spot; width: number; height: number }

/** Distances of a label from its point, as factors, in the order in which they are tried; large ones serve where many
    labels are close together. */
const distances = [1, 2, 3.5, 5.5];

function placesFor({at: {x, y}, width, height}: Wish): Spot[] {
  return distances.flatMap((factor) => {
    const right = x + 14 * factor, left = x - 14 * factor - width;
    const below = y + 8 * factor, above = y - 8 * factor - height;
    return [{x: right, y: below}, {x: right, y: above}, {x: left, y: below}, {x: left, y: above},
            {x: x - width / 2, y: below + 8 * factor}, {x: x - width / 2, y: above - 8 * factor}];
  });
}

/** Finds positions at which labels cover neither each other nor the boxes in taken and stay on the picture; null where
    there is none. before: the previous choice of each label, which is kept where possible and updated. */
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
