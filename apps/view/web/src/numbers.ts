import type {Robot} from './robot';
import {byId, digits, element, mm, plain} from './text';
import {loadWords, measureWords} from './words';

/** Shows the positions of the markers; returns the function that updates them. */
export function makeTable(robot: Robot): () => void {
  const {markers} = robot.document, box = byId('table');
  const cells = markers.map(() => [0, 1, 2, 3].map(() => element('td')));
  box.append(element('table', {}, headOf('Marker', 'x', 'y', 'z', 'displacement'),
    element('tbody', {}, ...markers.map(({name}, i) => element('tr', {}, cell(plain(name)), ...cells[i])))));
  return () => robot.pose.markers.forEach((at, i) => {
    const moved = Math.hypot(...at.map((x, k) => x - markers[i].at[k]));
    [...at, moved].forEach((value, k) => { cells[i][k].textContent = mm(value); });
  });
}

/** Shows loads, lengths, areas and volumes of the actuators; returns the function that updates them. */
export function makeOutputs(robot: Robot): () => void {
  const {actuators} = robot.document, box = byId('outputs');
  const rows = actuators.flatMap((actuator, a) => {
    const row = (words: string, unit: string, values: () => (number | null)[]) =>
      ({name: plain(actuator.name), words, unit, value: () => values()[a], cell: element('td')});
    return [
      ...(actuator.load_unit ? [row(loadWords(actuator), actuator.load_unit, () => robot.pose.loads)] : []),
      ...(actuator.measure_unit ? [row(measureWords(actuator), actuator.measure_unit, () => robot.pose.measures)] : []),
    ];
  });
  byId('outputs-section').hidden = rows.length === 0;
  box.append(element('table', {}, headOf('Actuator', 'quantity', 'value', 'unit'), element('tbody', {},
    ...rows.map(({name, words, unit, cell: value}) =>
      element('tr', {}, cell(name), cell(words), value, cell(unit))))));
  return () => {
    for (const {cell: shown, value} of rows) shown.textContent = digits(value(), 5);
  };
}

const headOf = (...words: string[]): HTMLElement =>
  element('thead', {}, element('tr', {}, ...words.map((word) => element('th', {scope: 'col'}, word))));

const cell = (text: string): HTMLElement => element('td', {}, text);

/** Shows the command, the version and the errors of the map. */
export function showOrigin(robot: Robot): void {
  const {command, softkin, formulation} = robot.document, box = byId('origin'), {map, steps} = robot;
  box.replaceChildren(element('p', {}, `Computed by softkin ${softkin}, a finite-element program for soft robots ` +
    `(${formulation} formulation), by the command`), element('code', {}, command));
  if (steps.length) {
    const seconds = steps.reduce((sum, step) => sum + step.seconds, 0), s = steps.length > 1 ? 's were' : ' was';
    box.append(element('p', {}, `${steps.length} step${s} solved in ${digits(seconds, 3)} s.`));
  }
  if (!map) return;
  const {checked, outputs} = map;
  const use = robot.document.live ? 'is shown until the solver has the exact shape'
    : 'gives the shapes and numbers here';
  box.append(element('p', {}, `A kinematic map ${use}: ` +
    `polynomials fitted to ${checked.equilibria} solved equilibria. ` +
    (checked.points > 0
      ? `At ${checked.points} other points its largest deviations from the solver were (this is not a bound):`
      : 'It was compared with the solver at no other point, so its errors are unknown.')));
  if (checked.points === 0) return;
  const rows = outputs.map(({name, unit, largestError, meanError}) => element('tr', {}, cell(plain(name)),
    cell(`${digits(largestError, 2)} ${unit}`), cell(`${digits(meanError, 2)} ${unit}`)));
  const {shapeLargestErrorMm: largest, shapeMeanErrorMm: mean} = checked;
  if (largest !== undefined)
    rows.push(element('tr', {}, cell('every vertex'), cell(`${digits(largest, 2)} mm`), cell(`${digits(mean, 2)} mm`)));
  box.append(element('table', {}, headOf('Output', 'largest error', 'mean error'), element('tbody', {}, ...rows)));
}

/** Describes the shown shape in one line. bad: it is not the requested equilibrium. */
export function stateWords(robot: Robot): {text: string; bad: boolean} {
  const {report, from, step} = robot.pose;
  if (robot.link?.busy) {
    const now = from === 'map' && !robot.outside ? 'From the map' : 'The previous shape';
    return {text: `${now}; softkin is computing …`, bad: false};
  }
  if (robot.outside) return {text: 'Outside the map: the previous shape is shown.', bad: true};
  const {commands, document: {actuators}} = robot, isAtRest = actuators.every(({rest}, i) => commands[i] === rest);
  if (!report && from === 'rest') return {text: 'Reference shape, without loads', bad: false};
  if (!report) return {text: isAtRest ? 'Equilibrium at the rest commands, from the map' : 'From the map', bad: false};
  const {status, iterations, seconds, remark} = report, bad = status !== 'converged';
  const read = robot.values.filter((value) => value !== null).length;
  const how = robot.estimate ? `Estimated from ${read} reading${read === 1 ? '' : 's'}` : 'Computed';
  const text = `${from === 'step' ? `Step ${step + 1}` : how}: ${plain(status)}, ${iterations} iterations, ` +
    `${digits(seconds, 2)} s${remark ? ` – ${remark}` : ''}`;
  return {text: bad ? `${text}. The shape is the last equilibrium that was found.` : text, bad};
}
