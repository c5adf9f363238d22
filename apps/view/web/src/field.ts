import type {Actuator} from './document';

const dot = (a: number[], b: number[]): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const sum = (values: number[]): number => values.reduce((all, value) => all + value, 0);

/** Iterations of the least squares of a drag. Each at least halves the residual, unless two fields have nearly the same
    projection on the screen. */
const maxIterations = 200;
/** The projection of a field's direction on the screen has at least this fraction of its length; otherwise a small
    motion of the pointer would be a large command, and the field is left as it is. */
const minSeenFraction = 0.25;

/** Returns the sum of all uniform fields' flux densities [mT]; an unknown command counts as the rest command. */
export function fieldOf(actuators: Actuator[], commands: number[]): number[] {
  return [0, 1, 2].map((k) => sum(actuators.map(({flux_density: of, rest}, a) =>
    of ? of[k] * (Number.isFinite(commands[a]) ? commands[a] : rest) : 0)));
}

/** Returns the largest flux density of the uniform fields along x, y and z [mT]; null where there are none. */
export function largestField(actuators: Actuator[]): number[] | null {
  const largest = [0, 1, 2].map((k) => sum(actuators.map(({flux_density: of, low, high}) =>
    of ? Math.abs(of[k]) * Math.max(Math.abs(low), Math.abs(high)) : 0)));
  return largest.some((value) => value > 0) ? largest : null;
}

/** Returns commands inside their ranges that move the tip of the field's arrow by the dragged distance, in the least
    squares of its projection on the screen; of several solutions, one near the commands at the start. change: of the
    tip, perpendicular to the line of sight [mT]; sight: the direction of that line, of unit length. */
export function draggedField(actuators: Actuator[], start: number[], change: number[], sight: number[]): number[] {
  const seen = actuators.map(({flux_density: of}) => {
    const across = of?.map((value, k) => value - dot(of, sight) * sight[k]) ?? [0, 0, 0];
    return Math.hypot(...across) < minSeenFraction ? null : across;
  });
  const size = sum(seen.map((across) => across ? dot(across, across) : 0));
  const commands = start.slice();
  for (let n = 0; size > 0 && n < maxIterations; ++n) {
    const residual = change.map((value, k) => value -
      sum(seen.map((across, a) => across ? across[k] * (commands[a] - start[a]) : 0)));
    seen.forEach((across, a) => {
      const {low, high} = actuators[a];
      if (across) commands[a] = Math.min(Math.max(commands[a] + dot(across, residual) / size, low), high);
    });
  }
  return commands;
}
