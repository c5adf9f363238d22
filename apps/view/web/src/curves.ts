import type {Actuator} from './document';
import type {Robot} from './robot';
import {digits, plain} from './text';
import {commandWords, loadWords, measured} from './words';

const width = 340, height = 150, left = 46, right = 10, top = 20, bottom = 32;
const sweepPoints = 33, maxVisited = 400;

/** Creates an SVG element. */
export function drawn(tag: string, attributes: Record<string, string | number>, text = ''): SVGElement {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.textContent = text;
  return made;
}

/** Shows load against command of each actuator: the steps of the run, the values of the map with all other commands
    fixed, and the states to which the user moved the robot. Returns the function that updates the curves. */
export function makeCurves(box: HTMLElement, robot: Robot): () => void {
  const {steps, document: {actuators}} = robot;
  const visitedPoints: [number, number][][] = actuators.map(() => []);
  const svgs = actuators.map(({name, load_unit: unit}) => {
    const svg = drawn('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img',
                              'aria-label': `Load of ${plain(name)} against its command`});
    if (unit) box.append(svg);
    return svg;
  });
  return () => actuators.forEach((actuator, i) => {
    if (!actuator.load_unit) return;
    const {commands, loads, step} = robot.pose, load = loads[i];
    const now: [number, number][] = load === null ? [] : [[commands[i], load]];
    const visited = visitedPoints[i], last = visited.at(-1);
    if (step < 0 && (robot.map || robot.link))
      visited.push(...now.filter(([command, value]) => !last || last[0] !== command || last[1] !== value));
    if (visited.length > maxVisited) visited.shift();
    const computed = steps.flatMap((one): [number, number][] => {
      const value = one.loads[i];
      return value === null ? [] : [[one.commands[i], value]];
    });
    const sweep: [number, number][] = [];
    for (let k = 0; robot.map && k < sweepPoints; ++k) {
      const command = actuator.low + k / (sweepPoints - 1) * (actuator.high - actuator.low);
      const value = robot.evaluateMap(commands.map((c, j) => j === i ? command : c))?.loads[i];
      if (value !== undefined && value !== null) sweep.push([command, value]);
    }
    plot(svgs[i], actuator, {computed, sweep, visited, now});
  });
}

interface Lists {
  computed: [number, number][]; sweep: [number, number][]; visited: [number, number][]; now: [number, number][];
}

function plot(svg: SVGElement, actuator: Actuator, {computed, sweep, visited, now}: Lists): void {
  const values = [...computed, ...sweep, ...visited, ...now].map(([, load]) => load);
  const zero = actuator.load_unit === measured ? 1 : 0;  // a ratio is 1 in the reference shape
  const low = Math.min(zero, ...values), high = Math.max(...values, low + 1e-9);
  const x = (c: number) => left + (c - actuator.low) / (actuator.high - actuator.low) * (width - left - right);
  const y = (l: number) => height - bottom - (l - low) / (high - low) * (height - top - bottom);
  const line = (list: [number, number][]) => list.map(([c, l]) => `${x(c).toFixed(1)},${y(l).toFixed(1)}`).join(' ');
  const dots = (list: [number, number][], name: string, r: number) =>
    list.map(([c, l]) => drawn('circle', {class: name, cx: x(c).toFixed(1), cy: y(l).toFixed(1), r}));
  const base = height - bottom;
  svg.replaceChildren(
    drawn('path', {class: 'axis', d: `M${left},${top}V${base}H${width - right}`}),
    drawn('text', {x: left, y: 12}, `${plain(actuator.name)}: ${loadWords(actuator)} [${actuator.load_unit}]`),
    drawn('text', {x: left - 4, y: top + 5, 'text-anchor': 'end'}, digits(high, 3)),
    drawn('text', {x: left - 4, y: base, 'text-anchor': 'end'}, digits(low, 3)),
    drawn('text', {x: left, y: base + 13}, digits(actuator.low, 3)),
    drawn('text', {x: width - right, y: base + 13, 'text-anchor': 'end'}, digits(actuator.high, 3)),
    drawn('text', {x: (left + width - right) / 2, y: base + 26, 'text-anchor': 'middle'},
          `command [${commandWords(actuator)}]`),
    ...dots(visited, 'trail', 1.2), drawn('polyline', {class: 'sweep', points: line(sweep)}),
    drawn('polyline', {class: 'steps', points: line(computed)}), ...dots(computed, 'step', 3), ...dots(now, 'now', 5));
}
