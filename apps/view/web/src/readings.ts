import type {Actuator} from './document';
import {
  type Estimate, type EstimateDocument, fitText, forceText, placeText, plusMinus, type ReadingColumn,
  type EstimatedNumber,
} from './estimate';
import type {Robot} from './robot';
import {byId, digits, element, plain} from './text';
import {commandWords} from './words';

/** Formats a reading for its field. */
const fieldText = (value: number | null): string => value === null ? '' : String(Number(value.toPrecision(8)));
/** The largest magnitude that softkin accepts. */
const largest = 1e9;

/** Returns why a typed text is not a reading; empty for a valid reading or an empty field. */
export function whyNoReading(text: string, {name}: ReadingColumn): string {
  const value = Number(text);
  if (text.trim() === '') return '';
  if (!Number.isFinite(value)) return `${plain(name)}: type a number, or leave the field empty if there is no reading.`;
  return Math.abs(value) <= largest ? '' : `${plain(name)}: a number up to ${largest} is needed.`;
}

/** Returns the columns of each group, in order. */
export function groupsOf(columns: ReadingColumn[]): Map<string, number[]> {
  const groups = new Map<string, number[]>();
  columns.forEach(({group}, c) => groups.set(group, [...(groups.get(group) ?? []), c]));
  return groups;
}

/** Formats commands and readings as a table of softkin estimate with one row. */
export function readingsCsv({document, commands, values}: Robot): string {
  const of: EstimateDocument | undefined = document.live?.estimate, columns = of?.columns ?? [];
  const given = document.actuators.map(({name}, a) => ({column: name, value: commands[a]}))
    .filter((_, a) => !of?.told.includes(a));
  const read = columns.map(({name}, c) => ({column: name, value: values[c]})).filter(({value}) => value !== null);
  const all = [...given, ...read];
  return `${all.map(({column}) => column).join()}\n${all.map(({value}) => value).join()}\n`;
}

function makeFields(robot: Robot, columns: ReadingColumn[], box: HTMLElement): () => void {
  const wrong = element('p', {class: 'bad message', role: 'alert'});
  let wrongAt = robot.values;  // the message is valid until the readings change
  const fields = columns.map((column, c) => {
    const {group, axis, unit} = column;
    const field = element('input', {type: 'number', step: 'any', placeholder: '–',
                                    'aria-label': `${plain(group)}${axis && ` ${axis}`}, read, ${unit}`});
    field.addEventListener('change', () => {
      wrong.textContent = field.validity.badInput ? whyNoReading('?', column) : whyNoReading(field.value, column);
      field.setAttribute('aria-invalid', String(wrong.textContent !== ''));
      wrongAt = robot.values;
      if (wrong.textContent) return;
      const reading = field.value === '' ? null : Number(field.value);
      robot.setReadings(robot.values.map((value, k) => k === c ? reading : value));
    });
    return field;
  });
  const names: [string, HTMLElement][] = [];
  const rows = [...groupsOf(columns)].map(([group, of]) => {
    const {name: column, axis, unit, deviation} = columns[of[0]];
    // without the unit, which is at the end of the row
    const short = axis === '' ? column.replace(/_[^_]+$/, '') : group.replace(/^marker /, '');
    const name = element('td', {}, plain(short));
    names.push([group, name]);
    const cells = [0, 1, 2].map((k) => {
      const alone = k === 0 && axis === '' ? of[0] : -1;
      const c = of.find((each) => columns[each].axis === 'xyz'[k]) ?? alone;
      return element('td', {}, ...(c < 0 ? [] : [fields[c]]));
    });
    return element('tr', {}, name, ...cells, element('td', {}, `± ${digits(deviation, 2)} ${unit}`));
  });
  const head = [element('td'), ...['x', 'y', 'z', 'deviation'].map((word) => element('th', {scope: 'col'}, word))];
  const clear = element('button', {type: 'button'}, 'Clear the readings');
  clear.addEventListener('click', () => robot.setReadings(columns.map(() => null)));
  box.append(element('table', {}, element('thead', {}, element('tr', {}, ...head)), element('tbody', {}, ...rows)),
             wrong, element('div', {class: 'buttons'}, clear));
  return () => {
    if (wrong.textContent && robot.values !== wrongAt) {
      wrong.textContent = '';
      for (const field of fields) field.setAttribute('aria-invalid', 'false');
    }
    fields.forEach((field, c) => {
      field.disabled = !robot.able;
      if (document.activeElement !== field) field.value = fieldText(robot.values[c]);
    });
    clear.disabled = !robot.able || robot.values.every((value) => value === null);
    for (const [group, name] of names) name.classList.toggle('bad', robot.estimate?.left_out?.includes(group) ?? false);
  };
}

const sentence = (words: string): string =>
  `${words.replace(/^[tl](?=he |eft )/, (first) => first.toUpperCase()).replaceAll('+-', '±')}.`;

/** Explains the arrow, the cone and the ellipse. */
const meaning = (mmPerNewton: number, places: boolean): string =>
  `Arrow: the force, from its point of application; ${digits(mmPerNewton, 2)} mm are 1 N. Cone: its rim is the ` +
  'ellipse that contains the arrow\'s tip, across the arrow, with a probability of 90 %: ' +
  '2.15 standard deviations (2-D factor), or 1.64 where only one component across it is estimated. ' +
  (places ? 'Ellipse at its foot: the force acts inside it, on the surface, with a probability of 90 % ' +
   '(2.15 standard deviations). ' : '') +
  'This assumes normally distributed errors.';

/** Returns the unit of an estimated number; that of a ratio is in words: "× rest length". */
export const unitOf = ({name, unit}: EstimatedNumber, actuators: Actuator[]): string =>
  unit || actuators.filter((actuator) => actuator.name === name).map(commandWords).join('');

function showEstimate(estimate: Estimate, actuators: Actuator[], box: HTMLElement, mmPerNewton: number): void {
  const {numbers = [], places = [], forces = [], words = [], status, remark} = estimate;
  const rows = numbers.map((number) => element('tr', {}, element('td', {}, plain(number.name)),
    element('td', {}, plusMinus(number.value, number.deviation, unitOf(number, actuators)))));
  box.replaceChildren(
    ...forces.map((force) => element('p', {class: 'force'}, forceText(force))),
    ...places.map((place) => element('p', {},
      `${plain(place.force)} acts, in the reference shape, at ${placeText(place)}`)),
    ...(rows.length ? [element('table', {}, element('tbody', {}, ...rows))] : []),
    ...(status === 'converged' ? [element('p', {}, fitText(estimate))]
      : [element('p', {class: 'bad message'}, `There is no estimate: ${status}${remark && ` – ${remark}`}.`)]),
    ...words.map((word) => element('p', {class: `${/^left out|do not fit/.test(word) ? 'bad ' : ''}message`},
                                   sentence(word))),
    ...(forces.length ? [element('p', {class: 'explain'}, meaning(mmPerNewton, places.length > 0))] : []));
}

/** Shows fields for the readings, and the estimate; returns the function that updates them. */
export function makeReadings(robot: Robot, mmPerNewton: () => number): () => void {
  const of = robot.document.live?.estimate, box = byId('told');
  if (!of) return () => {};
  byId('readings-section').hidden = byId('told-section').hidden = false;
  byId('explain-readings').textContent = 'Type the readings; leave a field empty where there is no reading. ' +
    'Each change gives a new estimate.';
  const fields = makeFields(robot, of.columns, byId('readings'));
  let last: Estimate | null | undefined;
  return () => {
    fields();
    if (last === robot.estimate) return;
    last = robot.estimate;
    if (last) showEstimate(last, robot.document.actuators, box, mmPerNewton());
    else box.replaceChildren(element('p', {class: 'explain'}, 'There are no readings yet.'));
  };
}
