import {colourAt, regionColour, type Scale, scaleOf} from './colours';
import type {Robot} from './robot';
import type {Part, RobotScene} from './scene';
import {byId, element, plain} from './text';
import {labelledTicks} from './ticks';

interface Field { name: string; words: string; unit: string; about: number | null; fromZero: boolean }

/** Titles of the fields that softkin writes; other fields are shown with their names. */
const fieldTitles: Record<string, Omit<Field, 'name'>> = {
  strain: {words: 'Largest principal strain', unit: '%', about: null, fromZero: false},
  volume_ratio: {words: 'Volume ratio', unit: '× rest', about: 1, fromZero: false},
  contact_pressure: {words: 'Contact pressure', unit: 'kPa', about: null, fromZero: true},
};

const displacementField: Field =
  {name: 'displacement', words: 'Displacement from the reference shape', unit: 'mm', about: null, fromZero: true};

export function displacement(positions: Float32Array, rest: Float32Array): Float32Array {
  const distances = new Float32Array(rest.length / 3);
  for (let v = 0, k = 0; v < distances.length; ++v, k += 3)
    distances[v] = Math.hypot(positions[k] - rest[k], positions[k + 1] - rest[k + 1], positions[k + 2] - rest[k + 2]);
  return distances;
}

/** Values of the fields and their scales; in live mode a scale grows with the values that have been shown. */
class Colours {
  private readonly seen = new Map<string, Float32Array>();  // minimum and maximum
  private readonly last = new Map<string, Float32Array>();

  constructor(private readonly robot: Robot, shapes: Float32Array[]) {
    for (const shape of shapes) this.extendScale(displacementField.name, displacement(shape, robot.document.rest));
    for (const {fields} of robot.document.steps)
      for (const [name, values] of Object.entries(fields)) this.extendScale(name, values);
  }

  private extendScale(name: string, values: Float32Array): void {
    const {low, high} = scaleOf([values, ...(this.seen.has(name) ? [this.seen.get(name) as Float32Array] : [])], null,
                                false);
    this.seen.set(name, Float32Array.of(low, high));
  }

  /** Returns the values for the shown shape; in live mode the previous ones while softkin computes; null: unknown. */
  values({name}: Field): Float32Array | null {
    const {pose, document, link} = this.robot;
    const now = name === displacementField.name ? displacement(pose.positions, document.rest) : pose.fields[name];
    if (now && (link || pose.from === 'map')) this.extendScale(name, now);
    if (now) this.last.set(name, now);
    return now ?? (link && this.last.get(name)) ?? null;
  }

  scale({name, about, fromZero}: Field): Scale { return scaleOf([this.seen.get(name) ?? []], about, fromZero); }
}

function makeLegend(regions: string[]): HTMLElement {
  return element('div', {class: 'legend'}, ...regions.map((name, r) => {
    const dot = element('i');
    dot.style.background = regionColour(r);
    return element('span', {}, dot, plain(name));
  }));
}

function makeSwitches(robot: Robot, scene: RobotScene): HTMLElement[] {
  const {cables, workspace, obstacles, bodies, markers} = robot.document, {field} = scene;
  const around = obstacles.length + bodies.length > 0, marker = markers[workspace?.marker ?? 0]?.name ?? 'the marker';
  const switches: [Part, string, boolean, boolean][] = [
    ['ghost', 'reference shape (unloaded)', true, true],
    ['traces', 'marker trajectories', true, robot.steps.length > 1],
    ['markers', 'markers', true, true], ['workspace', `workspace of ${plain(marker)}`, true, workspace !== null],
    ['around', 'obstacles and bodies', true, around], ['field', 'magnetic field', true, field !== null],
    ['forces', 'estimated forces', true, robot.isEstimating],
    ['grid', 'grid', true, true], ['clear', 'transparent', cables.length > 0, true],
  ];
  return switches.filter(([, , , exists]) => exists).map(([part, words, on]) => {
    const check = element('input', {type: 'checkbox'});
    check.checked = on;
    check.addEventListener('change', () => scene.show(part, check.checked));
    scene.show(part, on);
    return element('label', {}, check, words);
  });
}

/** Controls for the body's colour and the visible parts; returns the function that updates them. */
export function makeLooks(robot: Robot, scene: RobotScene, shapes: Float32Array[]): () => void {
  const {steps, regions} = robot.document, box = byId('looks');
  const names = [...new Set(steps.flatMap((step) => Object.keys(step.fields)))];
  const fields = names.map((name): Field =>
    ({name, ...(fieldTitles[name] ?? {words: plain(name), unit: '', about: null, fromZero: false})}));
  const colours = new Colours(robot, shapes);
  const choose = element('select', {id: 'colour'},
    element('option', {value: displacementField.name}, 'displacement'),
    ...fields.map(({name, words}) => element('option', {value: name}, words)),
    element('option', {value: 'region'}, 'regions'));
  const legend = makeLegend(regions), note = element('p', {class: 'explain'});
  box.append(element('div', {class: 'choose'}, element('label', {for: 'colour'}, 'Colour'), choose), legend, note,
             ...makeSwitches(robot, scene));
  const update = () => {
    const field = [displacementField, ...fields].find(({name}) => name === choose.value);
    const values = field ? colours.values(field) : null, bar = byId('colour-bar');
    legend.hidden = field !== undefined;
    note.textContent = field && !values
      ? `${field.words} is available at the computed steps only: play them below the picture.` : '';
    bar.hidden = !field || !values;
    if (!field || !values) return scene.setColours(null, null);
    const scale = colours.scale(field);
    scene.setColours(values, scale);
    drawBar(scale, field);
  };
  choose.addEventListener('change', update);
  return update;
}

function drawBar({low, high, about}: Scale, {words, unit}: Field): void {
  const canvas = byId<HTMLCanvasElement>('bar'), context = canvas.getContext('2d');
  for (let i = 0; context && i < canvas.width; ++i) {
    context.fillStyle = `rgb(${colourAt(i / (canvas.width - 1), about).join()})`;
    context.fillRect(i, 0, 1, 1);
  }
  const factor = unit === '%' ? 100 : 1, [from, to] = [factor * low, factor * high];
  byId('bar-title').textContent = unit ? `${words} [${unit}]` : words;
  byId('bar-ticks').replaceChildren(...labelledTicks(from, to).map(({value, label}) => {
    const tick = element('span', {}, label);
    tick.style.left = `${(100 * (value - from) / (to - from)).toFixed(2)}%`;
    return tick;
  }));
}
