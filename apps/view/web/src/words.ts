import type {Actuator, Kind} from './document';

export const kindWords: Record<Kind, string> = {
  cable: 'cable', pneumatic: 'air chamber', dea: 'dielectric elastomer', magnetic: 'magnetic field', growth: 'growth',
  motion: 'obstacle motion', force: 'force', hold: 'held body', turn: 'rotated support',
};

/** Returns whether an actuator belongs to the robot, and not to its surroundings, such as a force on a gripped body. */
export const drives = ({kind}: Actuator): boolean => !['motion', 'force', 'hold', 'turn'].includes(kind);

/** Returns the unit of a command: "× rest length", "kPa". */
export function commandWords({unit, control}: Pick<Actuator, 'unit' | 'control'>): string {
  if (control === 'stretch') return '× rest length';
  return unit || (/^(length|area|volume)$/.test(control) ? `× rest ${control}` : '');
}

/** The unit of a length, area or volume as a ratio. */
export const measured = '× rest';

/** Returns the name of an actuator's measure: length, area or volume. */
export function measureWords({kind}: Pick<Actuator, 'kind'>): string {
  return {cable: 'length', dea: 'area'}[kind as string] ?? 'volume';
}

export function loadWords({kind, load_unit: unit}: Actuator): string {
  if (unit === measured || unit === 'mL') return measureWords({kind});  // mL: volume of a chamber that is flat at rest
  return {cable: 'tension', dea: 'voltage'}[kind as string] ?? 'pressure';
}
