import type {Actuator} from './document';
import type {Robot} from './robot';
import {digits, element, plain, withUnit} from './text';
import {commandWords, drives, kindWords, loadWords} from './words';

/** Loads below this are residuals of the solver or of the map and are shown as 0 [kPa, N]. */
const noLoad = 1e-4;

/** Formats a number for a field: few digits, yet as fine as the slider. */
const typed = (value: number): string => Number.isFinite(value) ? String(Number(value.toPrecision(6))) : '';

interface Row {
  actuator: Actuator; slider: HTMLInputElement; field: HTMLInputElement; load: HTMLElement; wrong: HTMLElement;
  wrongAt: number;  // the command at which a typed number was refused
}

/** Returns why a typed number is refused; empty where it is accepted. */
export function whyRefused(text: string, {name, low, high, unit, control}: Actuator): string {
  if (text.trim() === '' || !Number.isFinite(Number(text))) return `${plain(name)}: type a number.`;
  const value = Number(text);
  if (value >= low && value <= high) return '';
  const words = commandWords({unit, control});
  return `${plain(name)}: ${typed(value)} is outside its range, ` +
    `${withUnit(`${typed(low)} to ${typed(high)}`, words)}. The command is unchanged.`;
}

function makeRow(actuator: Actuator, i: number, isEstimated: boolean): Row & {whole: HTMLElement} {
  const {low, high} = actuator, id = `actuator-${i}`, name = plain(actuator.name), unit = commandWords(actuator);
  const step = high > low ? (high - low) / 1000 : 'any';
  const slider = element('input', {type: 'range', id, min: low, max: high, step});
  const field = element('input', {type: 'number', min: low, max: high, step: 'any',
                                  'aria-label': `${name}, typed${unit && `, ${unit}`}`});
  const load = element('span', {class: 'load'}), wrong = element('p', {class: 'bad message', role: 'alert'});
  const whole = element('div', {class: 'slider'},
    element('div', {class: 'row'}, element('label', {for: id}, name),
            element('span', {class: 'kind'}, kindWords[actuator.kind] + (isEstimated ? ', estimated' : '')), load),
    slider,
    element('div', {class: 'ends'}, element('span', {}, digits(low, 3)), element('span', {class: 'typed'}, field, unit),
            element('span', {}, digits(high, 3))),
    wrong);
  return {actuator, slider, field, load, wrong, wrongAt: NaN, whole};
}

/** Shows a slider for each actuator; returns the function that updates them. */
export function makeSliders(box: HTMLElement, robot: Robot): () => void {
  const around = element('details', {}, element('summary', {}, 'Commands of obstacles, bodies and supports'));
  const estimated = robot.document.live?.estimate?.told ?? [];
  const rows = robot.document.actuators.map((actuator, i) => {
    const row = makeRow(actuator, i, estimated.includes(i)), {slider, field, wrong, whole} = row;
    const showError = (message: string) => {
      wrong.textContent = message;
      field.setAttribute('aria-invalid', String(message !== ''));
      row.wrongAt = robot.commands[i];
    };
    let moving = false;  // so that one drag is undone as a whole
    const command = (value: number) => {
      const commands = robot.commands.slice();
      commands[i] = Math.min(Math.max(value, actuator.low), actuator.high);
      robot.command(commands);
    };
    slider.addEventListener('change', () => { moving = false; });
    slider.addEventListener('input', () => {
      showError('');
      if (!moving) robot.remember();
      moving = true;
      command(Number(slider.value));
    });
    field.addEventListener('change', () => {
      showError(whyRefused(field.value, actuator));
      if (wrong.textContent) return;
      robot.remember();
      command(Number(field.value));
      field.value = typed(robot.commands[i]);
    });
    field.addEventListener('blur', () => { field.value = typed(robot.commands[i]); });
    slider.hidden = actuator.kind === 'force';  // the range of a force is no useful slider
    (drives(actuator) ? box : around).append(whole);
    return row;
  });
  if (around.childElementCount > 1) box.append(around);
  return () => rows.forEach(({actuator, slider, field, load, wrong, wrongAt}, i) => {
    const command = robot.commands[i], force = robot.pose.loads[i];
    const isEstimated = estimated.includes(i);
    if (wrong.textContent && command !== wrongAt) wrong.textContent = '';
    slider.disabled = field.disabled = !robot.able || actuator.low === actuator.high || isEstimated;
    slider.value = String(command);
    slider.setAttribute('aria-valuetext', `${digits(command)} ${commandWords(actuator)}`);
    if (document.activeElement !== field) field.value = typed(command);
    load.textContent = force === null || !actuator.load_unit ? '' :
      `${loadWords(actuator)} ${withUnit(digits(Math.abs(force) < noLoad ? 0 : force, 3), actuator.load_unit)}`;
  });
}
