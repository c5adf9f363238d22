import type {Actuator} from './document';
import type {Robot} from './robot';
import {digits, element, plain, withUnit} from './text';
import {commandWords, drives, kindWords, loadWords} from './words';

/** Less is what a solver or a map leaves [kPa, N]. */
const noLoad = 1e-4;

/** Of a number that is typed: no more digits than people read, yet as fine as the slider. */
const typed = (value: number): string => Number.isFinite(value) ? String(Number(value.toPrecision(6))) : '';

interface Row {
  actuator: Actuator; slider: HTMLInputElement; field: HTMLInputElement; load: HTMLElement; wrong: HTMLElement;
  wrongAt: number;  // the command when a number was not taken
}

/** Why a number that was typed is not taken; empty: it is. */
export function whyNotTaken(text: string, {name, low, high, unit, control}: Actuator): string {
  if (text.trim() === '' || !Number.isFinite(Number(text))) return `${plain(name)}: type a number.`;
  const value = Number(text);
  if (value >= low && value <= high) return '';
  const words = commandWords({unit, control});
  return `${plain(name)}: ${typed(value)} is outside its range, ` +
    `${withUnit(`${typed(low)} to ${typed(high)}`, words)}. The command is unchanged.`;
}

function makeRow(actuator: Actuator, i: number, isTold: boolean): Row & {whole: HTMLElement} {
  const {low, high} = actuator, id = `actuator-${i}`, name = plain(actuator.name), unit = commandWords(actuator);
  const step = high > low ? (high - low) / 1000 : 'any';
  const slider = element('input', {type: 'range', id, min: low, max: high, step});
  const field = element('input', {type: 'number', min: low, max: high, step: 'any',
                                  'aria-label': `${name}, typed${unit && `, ${unit}`}`});
  const load = element('span', {class: 'load'}), wrong = element('p', {class: 'bad message', role: 'alert'});
  const whole = element('div', {class: 'slider'},
    element('div', {class: 'row'}, element('label', {for: id}, name),
            element('span', {class: 'kind'}, kindWords[actuator.kind] + (isTold ? ', estimated' : '')), load),
    slider,
    element('div', {class: 'ends'}, element('span', {}, digits(low, 3)), element('span', {class: 'typed'}, field, unit),
            element('span', {}, digits(high, 3))),
    wrong);
  return {actuator, slider, field, load, wrong, wrongAt: NaN, whole};
}

/** One slider for each actuator; returns what brings them up to date. */
export function makeSliders(box: HTMLElement, robot: Robot): () => void {
  const around = element('details', {}, element('summary', {}, 'Commands of obstacles, bodies and supports'));
  const told = robot.document.live?.estimate?.told ?? [];
  const rows = robot.document.actuators.map((actuator, i) => {
    const row = makeRow(actuator, i, told.includes(i)), {slider, field, wrong, whole} = row;
    const tell = (why: string) => {
      wrong.textContent = why;
      field.setAttribute('aria-invalid', String(why !== ''));
      row.wrongAt = robot.commands[i];
    };
    let moving = false;  // one drag is undone as a whole
    const command = (value: number) => {
      const commands = robot.commands.slice();
      commands[i] = Math.min(Math.max(value, actuator.low), actuator.high);
      robot.command(commands);
    };
    slider.addEventListener('change', () => { moving = false; });
    slider.addEventListener('input', () => {
      tell('');
      if (!moving) robot.remember();
      moving = true;
      command(Number(slider.value));
    });
    field.addEventListener('change', () => {
      tell(whyNotTaken(field.value, actuator));
      if (wrong.textContent) return;
      robot.remember();
      command(Number(field.value));
      field.value = typed(robot.commands[i]);
    });
    field.addEventListener('blur', () => { field.value = typed(robot.commands[i]); });
    slider.hidden = actuator.kind === 'force';  // its range says nothing
    (drives(actuator) ? box : around).append(whole);
    return row;
  });
  if (around.childElementCount > 1) box.append(around);
  return () => rows.forEach(({actuator, slider, field, load, wrong, wrongAt}, i) => {
    const command = robot.commands[i], force = robot.pose.loads[i];
    const isTold = told.includes(i);
    if (wrong.textContent && command !== wrongAt) wrong.textContent = '';
    slider.disabled = field.disabled = !robot.able || actuator.low === actuator.high || isTold;
    slider.value = String(command);
    slider.setAttribute('aria-valuetext', `${digits(command)} ${commandWords(actuator)}`);
    if (document.activeElement !== field) field.value = typed(command);
    load.textContent = force === null || !actuator.load_unit ? '' :
      `${loadWords(actuator)} ${withUnit(digits(Math.abs(force) < noLoad ? 0 : force, 3), actuator.load_unit)}`;
  });
}
