import {type RobotDocument, robotName} from './document';

/** Options of the solver that a line keeps from the one that made the page; the number of their values. */
const kept: Record<string, number> = {
  '--force': 1, '--formulation': 1, '--solver': 1, '--solver-tolerance': 1, '--max-iterations': 1, '--anderson': 1,
  '--stable': 0,
};
/** Those of what is told; a table of one row does not fade. */
const keptToTell: Record<string, number> = {
  '--unknown': 1, '--deviation': 1, '--deviation-pressure': 1, '--deviation-tension': 1, '--deviation-length': 1,
  '--deviation-volume': 1, '--deviation-force': 1, '--deviation-angle': 1, '--keep-all': 0,
};

/** Words of a line, as a shell of POSIX reads them. */
export function wordsOf(line: string): string[] {
  const words: string[] = [];
  for (const [whole] of line.matchAll(/(?:[^\s'\\]|\\.|'[^']*')+/g))
    words.push(whole.replace(/'([^']*)'|\\(.)/g, (_, quoted: string | undefined, one: string) => quoted ?? one));
  return words;
}

export const quoted = (word: string): string =>
  /^[\w\-+=./:,@%]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;

/** The scene's file in a line of softkin, which comes first after its subcommand. */
export function sceneOf(robot: RobotDocument): string {
  const words = wordsOf(robot.command).slice(2);
  return words.find((word) => /\.ya?ml$/i.test(word)) ?? `${robotName(robot)}.yaml`;
}

/** The line that computes a state again. */
export function lineOf(robot: RobotDocument, commands: number[]): string {
  const told = robot.live?.estimate, options = told ? {...kept, ...keptToTell} : kept;
  const words = ['softkin', ...(told ? ['estimate', sceneOf(robot), 'readings.csv'] : ['fk', sceneOf(robot)])];
  const given = wordsOf(robot.command);
  given.forEach((word, i) => {
    const [name] = word.split('=');
    if (!(name in options)) return;
    words.push(word, ...(word.includes('=') ? [] : given.slice(i + 1, i + 1 + options[name])));
  });
  if (told) return words.map(quoted).join(' ');
  robot.actuators.forEach(({name, unit}, a) => words.push('--set', `${name}=${commands[a]}${unit}`));
  return words.map(quoted).join(' ');
}
