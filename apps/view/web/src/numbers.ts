import type {Robot} from './robot';
import {byId, digits, element, mm, plain} from './text';

/** Where the markers are; returns what brings it up to date. */
export function makeTable(robot: Robot): () => void {
  const {markers} = robot.document, box = byId('table');
  const cells = markers.map(() => [0, 1, 2, 3].map(() => element('td')));
  box.append(element('table', {}, headOf('Marker', 'x', 'y', 'z', 'moved'),
    element('tbody', {}, ...markers.map(({name}, i) => element('tr', {}, cell(plain(name)), ...cells[i])))));
  return () => robot.pose.markers.forEach((at, i) => {
    const moved = Math.hypot(...at.map((x, k) => x - markers[i].at[k]));
    [...at, moved].forEach((value, k) => { cells[i][k].textContent = mm(value); });
  });
}

const headOf = (...words: string[]): HTMLElement =>
  element('thead', {}, element('tr', {}, ...words.map((word) => element('th', {scope: 'col'}, word))));

const cell = (text: string): HTMLElement => element('td', {}, text);

/** Command, version, and how far the map may be off. */
export function tellOrigin(robot: Robot): void {
  const {command, softkin, formulation} = robot.document, box = byId('origin'), {map, steps} = robot;
  box.replaceChildren(element('p', {}, `Computed by softkin ${softkin}, a finite-element program for soft robots ` +
    `(${formulation} formulation), with`), element('code', {}, command));
  if (steps.length) {
    const seconds = steps.reduce((sum, step) => sum + step.seconds, 0), s = steps.length > 1 ? 's were' : ' was';
    box.append(element('p', {}, `${steps.length} step${s} solved in ${digits(seconds, 3)} s.`));
  }
  if (!map) return;
  const {checked, outputs} = map;
  const what = robot.document.live ? 'What is shown at once, before the exact shape,' : 'What moves here';
  box.append(element('p', {}, `${what} is a closed formula made of ${checked.equilibria} solved shapes. ` +
    `Checked at ${checked.points} other points against the solver, it was off by at most (no bound):`));
  const rows = outputs.map(({name, unit, largestError, meanError}) => element('tr', {}, cell(plain(name)),
    cell(`${digits(largestError, 2)} ${unit}`), cell(`${digits(meanError, 2)} ${unit}`)));
  const {shapeLargestErrorMm: most, shapeMeanErrorMm: mean} = checked;
  if (most !== undefined)
    rows.push(element('tr', {}, cell('every vertex'), cell(`${digits(most, 2)} mm`), cell(`${digits(mean, 2)} mm`)));
  box.append(element('table', {}, headOf('off by', 'at most', 'on average'), element('tbody', {}, ...rows)));
}

/** One line on what is shown; bad: it is not what was asked for. */
export function stateWords(robot: Robot): {text: string; bad: boolean} {
  const {told, from, step} = robot.pose;
  if (robot.link?.busy) {
    const now = from === 'map' && !robot.outside ? 'From the map' : 'The shape before';
    return {text: `${now}; softkin is computing …`, bad: false};
  }
  if (robot.outside) return {text: 'Outside the map: the shape before is shown.', bad: true};
  const {commands, document: {actuators}} = robot, rests = actuators.every(({rest}, i) => commands[i] === rest);
  if (!told) return {text: from === 'map' && !rests ? 'From the map' : 'At rest', bad: false};
  const {status, iterations, seconds, remark} = told, bad = status !== 'converged';
  const read = robot.values.filter((value) => value !== null).length;
  const how = robot.estimate ? `Told from ${read} reading${read === 1 ? '' : 's'}` : 'Computed';
  const text = `${from === 'step' ? `Step ${step + 1}` : how}: ${plain(status)}, ${iterations} iterations, ` +
    `${digits(seconds, 2)} s${remark ? ` – ${remark}` : ''}`;
  return {text: bad ? `${text}. The shape is the last one that was found.` : text, bad};
}
