import type {Actuator, Kind} from './document';

export const kindWords: Record<Kind, string> = {
  cable: 'cable', pneumatic: 'air chamber', dea: 'dielectric elastomer', magnetic: 'magnetic field', growth: 'growth',
  motion: 'moved obstacle', force: 'force', hold: 'hold on a body', turn: 'turned support',
};

/** Not done to what is around the robot, such as a force on a body that it holds. */
export const drives = ({kind}: Actuator): boolean => !['motion', 'force', 'hold', 'turn'].includes(kind);

/** What is commanded, as a unit: "× rest length", "kPa". */
export function commandWords({unit, control}: Pick<Actuator, 'unit' | 'control'>): string {
  if (control === 'stretch') return '× rest length';
  return unit || (/^(length|area|volume)$/.test(control) ? `× rest ${control}` : '');
}

/** Of what is commanded by its load, the volume or area that comes of it. */
export const measured = '× rest';

export function loadWords({kind, load_unit: unit}: Actuator): string {
  if (unit === measured) return kind === 'dea' ? 'area' : 'volume';
  if (unit === 'mL') return 'volume';  // of a chamber that is flat at rest
  return {cable: 'tension', dea: 'voltage'}[kind as string] ?? 'pressure';
}
