import {lineOf, sceneOf} from './command_line';
import {inRange, PathError} from './csv';
import {type Actuator, robotName} from './document';
import type {Robot} from './robot';

/** Quotes a string for YAML; a string of JSON is valid YAML. */
const quotedYaml = (text: string): string => JSON.stringify(text);

/** Formats the commands and the positions of the markers as YAML. */
export function yamlOf(robot: Robot): string {
  const {document, pose, target} = robot, {actuators, markers} = document, {commands} = pose;
  const places = (at: number[]) => `[${at.map((value) => Number(value.toFixed(6))).join(', ')}]`;
  return [
    `# A state of ${robotName(document)}, saved from its page. To compute it again:`,
    `#   ${lineOf(document, commands)}`,
    `scene: ${quotedYaml(sceneOf(document))}`,
    `softkin: ${quotedYaml(document.softkin)}`,
    'commands:',
    ...actuators.map(({name, unit}, a) => `  ${quotedYaml(name)}: ${commands[a]}${unit && `  # ${unit}`}`),
    'markers_mm:',
    ...markers.map(({name}, i) => `  ${quotedYaml(name)}: ${places(pose.markers[i])}`),
    ...(target ? ['target_mm:', `  ${quotedYaml(markers[target.marker].name)}: ${places(target.at)}`] : []),
  ].join('\n') + '\n';
}

/** Reads the commands of a saved state; other actuators have their rest commands. Throws PathError. */
export function readState(text: string, actuators: Actuator[]): number[] {
  const commands = actuators.map(({rest, low, high}) => Math.min(Math.max(rest, low), high));
  let isInCommands = false, found = 0;
  text.split(/\r\n|\n|\r/).forEach((line, n) => {
    const pair = /^\s+("(?:[^"\\]|\\.)*"|[^\s:#"]+)\s*:\s*(\S+)/.exec(line);
    if (/^\S/.test(line) && !line.startsWith('#')) isInCommands = /^commands:/.test(line);
    if (!isInCommands || !pair) return;
    const name = pair[1].startsWith('"') ? String(JSON.parse(pair[1])) : pair[1], value = Number(pair[2]);
    const a = actuators.findIndex((actuator) => actuator.name === name);
    if (a < 0) throw new PathError(`Line ${n + 1}: there is no actuator ${name}: the state is of another robot.`);
    if (!Number.isFinite(value)) throw new PathError(`Line ${n + 1}: ${name} must be a number, not "${pair[2]}".`);
    commands[a] = inRange(value, actuators[a], n + 1, name);
    ++found;
  });
  if (!found) throw new PathError('It has no commands: a state that this page saved is needed, or a CSV file.');
  return commands;
}
