import type {Actuator} from './document';

const dot = (a: number[], b: number[]): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const sum = (values: number[]): number => values.reduce((all, value) => all + value, 0);

/** Rounds that lead a drag to its commands; each halves what is left, or better, but where two arrows look alike. */
const rounds = 200;
/** Of its length, so much of a direction must be seen, or a small move of the pointer would be a large command. */
const leastSeen = 0.25;

/** The flux density that all uniform fields make together [mT]; a command that is not known is that at rest. */
export function fieldOf(actuators: Actuator[], commands: number[]): number[] {
  return [0, 1, 2].map((k) => sum(actuators.map(({flux_density: of, rest}, a) =>
    of ? of[k] * (Number.isFinite(commands[a]) ? commands[a] : rest) : 0)));
}

/** The most that uniform fields can make along x, y and z [mT]; null: there are none. */
export function largestField(actuators: Actuator[]): number[] | null {
  const most = [0, 1, 2].map((k) => sum(actuators.map(({flux_density: of, low, high}) =>
    of ? Math.abs(of[k]) * Math.max(Math.abs(low), Math.abs(high)) : 0)));
  return most.some((value) => value > 0) ? most : null;
}

/** Commands inside their ranges that move the tip of the field's arrow as far as it was dragged, by least squares of
    what is seen; of several that do, those near the commands at the start. change: of the tip, across the way from the
    eye [mT]; eye: that way, of unit length. */
export function draggedField(actuators: Actuator[], start: number[], change: number[], eye: number[]): number[] {
  const seen = actuators.map(({flux_density: of}) => {
    const across = of?.map((value, k) => value - dot(of, eye) * eye[k]) ?? [0, 0, 0];
    return Math.hypot(...across) < leastSeen ? null : across;
  });
  const size = sum(seen.map((across) => across ? dot(across, across) : 0));
  const commands = start.slice();
  for (let round = 0; size > 0 && round < rounds; ++round) {
    const left = change.map((value, k) => value -
      sum(seen.map((across, a) => across ? across[k] * (commands[a] - start[a]) : 0)));
    seen.forEach((across, a) => {
      const {low, high} = actuators[a];
      if (across) commands[a] = Math.min(Math.max(commands[a] + dot(across, left) / size, low), high);
    });
  }
  return commands;
}
