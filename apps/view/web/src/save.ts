import {lineOf} from './command_line';
import {robotName} from './document';
import {displacement} from './looks';
import {readingsCsv} from './readings';
import type {Robot} from './robot';
import {yamlOf} from './state';
import {byId, element} from './text';
import {vtuOf} from './vtu';

export function download(name: string, content: Blob): void {
  const link = element('a', {download: name, href: URL.createObjectURL(content)});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function shapeFile(robot: Robot): string {
  const {document: {rest, triangles, region}, pose} = robot;
  const {positions, fields} = pose;
  return vtuOf({positions, triangles, region, vectors: {displacement: positions.map((x, k) => x - rest[k])},
                scalars: {displacement_magnitude: displacement(positions, rest), ...fields}});
}

/** Buttons that save the shown state; returns the function that updates the command line. */
export function makeSave(robot: Robot): () => void {
  const box = byId('save'), line = element('textarea', {readonly: '', rows: 3, 'aria-label': 'Command for a terminal',
                                                        spellcheck: 'false'});
  const button = (words: string, act: () => void) => {
    const made = element('button', {type: 'button'}, words);
    made.addEventListener('click', act);
    return made;
  };
  const name = robotName(robot.document), message = element('span', {role: 'status', class: 'explain'});
  const copy = async () => {
    line.select();
    try {
      await navigator.clipboard.writeText(line.value);
      message.textContent = 'Copied.';
    } catch {
      message.textContent = 'Press Ctrl+C: the command is selected.';
    }
  };
  box.append(
    element('p', {class: 'explain'}, 'Save the shown state:'),
    element('div', {class: 'buttons'},
      robot.isEstimating
        ? button('Readings (CSV)', () => download('readings.csv', new Blob([readingsCsv(robot)], {type: 'text/csv'})))
        : button('State (YAML)', () => download(`${name}.state.yaml`, new Blob([yamlOf(robot)], {type: 'text/yaml'}))),
      button('Shape (VTU)', () => download(`${name}.vtu`, new Blob([shapeFile(robot)], {type: 'application/xml'})))),
    element('p', {class: 'explain'}, 'The command that computes it again:'), line,
    element('div', {class: 'buttons'}, button('Copy the command', () => void copy()), message));
  return () => {
    const text = lineOf(robot.document, robot.pose.commands);
    if (line.value === text) return;
    line.value = text;
    message.textContent = '';
  };
}
