import {type RobotDocument, robotName} from './document';

/** Solver options that are copied from the command that made the page, with the number of their values. */
const solverOptions: Record<string, number> = {
  '--force': 1, '--formulation': 1, '--solver': 1, '--solver-tolerance': 1, '--max-iterations': 1, '--anderson': 1,
  '--options': 1,
  '--stable': 0,
};
/** The same for options of an estimate; --fade is not copied, as it has no effect on a table of one row. */
const estimateOptions: Record<string, number> = {
  '--unknown': 1, '--deviation': 1, '--deviation-pressure': 1, '--deviation-tension': 1, '--deviation-length': 1,
  '--deviation-volume': 1, '--deviation-force': 1, '--deviation-angle': 1, '--keep-all': 0,
};

/** Splits a line into words as a POSIX shell does. */
export function wordsOf(line: string): string[] {
  const words: string[] = [];
  for (const [whole] of line.matchAll(/(?:[^\s'\\]|\\.|'[^']*')+/g))
    words.push(whole.replace(/'([^']*)'|\\(.)/g, (_, quoted: string | undefined, one: string) => quoted ?? one));
  return words;
}

export const quoted = (word: string): string =>
  /^[\w\-+=./:,@%]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;

/** Returns the scene file in a command line of softkin, where it is the first argument of the subcommand. */
export function sceneOf(robot: RobotDocument): string {
  const words = wordsOf(robot.command).slice(2);
  return words.find((word) => /\.ya?ml$/i.test(word)) ?? `${robotName(robot)}.yaml`;
}

/** Returns the command line that computes a state again. */
export function lineOf(robot: RobotDocument, commands: number[]): string {
  const estimate = robot.live?.estimate;
  const options = estimate ? {...solverOptions, ...estimateOptions} : solverOptions;
  const words = ['softkin', ...(estimate ? ['estimate', sceneOf(robot), 'readings.csv'] : ['fk', sceneOf(robot)])];
  const given = wordsOf(robot.command);
  given.forEach((word, i) => {
    const [name] = word.split('=');
    if (!(name in options)) return;
    words.push(word, ...(word.includes('=') ? [] : given.slice(i + 1, i + 1 + options[name])));
  });
  if (estimate) return words.map(quoted).join(' ');
  robot.actuators.forEach(({name, unit}, a) => words.push('--set', `${name}=${commands[a]}${unit}`));
  return words.map(quoted).join(' ');
}
