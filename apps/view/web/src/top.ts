import {robotName} from './document';
import {largestField} from './field';
import type {LiveState} from './live';
import {whyOff} from './live_panel';
import type {Robot} from './robot';
import type {RobotScene} from './scene';
import {byId, digits, element, plain} from './text';
import {drives, kindWords} from './words';

function partsOf(robot: Robot): string {
  const actuators = robot.document.actuators.filter(drives);
  const kinds = [...new Set(actuators.map(({kind}) => kind))].map((kind) => {
    const count = actuators.filter((actuator) => actuator.kind === kind).length;
    return `${count} ${kindWords[kind]}${count > 1 ? 's' : ''}`;
  });
  return kinds.length > 1 ? `${kinds.slice(0, -1).join(', ')} and ${kinds.at(-1)}` : kinds[0] ?? 'nothing';
}

/** What the robot is and what can be done with it. */
export function tellAtTop(robot: Robot): void {
  const name = plain(robotName(robot.document)), {live} = robot.document;
  document.title = `${name} – softkin`;
  byId('robot').textContent = name;
  byId('about-robot').textContent =
    `A soft robot moved by ${partsOf(robot)}. Its shape ${live ? 'is' : 'was'} computed; lengths are in mm.`;
  const movable = live || robot.map, field = largestField(robot.document.actuators) !== null;
  byId('hint').textContent = movable
    ? `Move a slider, or drag the round marker${field ? ', its arrows or the tip of the field' : ' or its arrows'}: ` +
      'the robot follows. ' +
      'Drag beside it to look from elsewhere. Pale: the shape at rest.'
    : 'Play the steps, or drag here to look from elsewhere. Pale: the shape at rest.';
}

/** What the sliders do now; live: null where no program runs. */
export function tellAtSliders(robot: Robot, live: LiveState | null): void {
  const {actuators, map} = {actuators: robot.document.actuators, map: robot.map}, box = byId('explain-actuators');
  const off = live ? whyOff(live) : '', a = actuators.length > 1 ? 'a' : 'the';
  const text = off || (map || live ? `Drag ${a} slider or type a number: the robot bends.`
    : 'What each actuator does at this step. Play the steps below the picture.');
  if (box.textContent === text) return;
  box.textContent = text;
  box.classList.toggle('off', off !== '');
}

function put(label: HTMLElement, x: number, y: number): void {
  label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
}

/** Names of the markers and letters of the arrows, over the picture; returns what puts them in their places. */
export function makeLabels(robot: Robot, scene: RobotScene): () => void {
  const {markers} = robot.document, box = byId('labels');
  const labels = markers.map(() => element('span')), letters = [0, 1, 2].map((k) => element('b', {}, 'xyz'[k]));
  box.append(...labels, ...letters);
  const field = makeFieldLabel(box, robot, scene);
  let touched = false;
  return () => {
    touched ||= robot.target !== null;
    labels.forEach((label, i) => {
      const {x, y} = scene.project(robot.pose.markers[i]), name = plain(markers[i].name);
      const reach = robot.canReach(i);
      const text = reach && !touched && i === robot.selected ? `${name}: drag me` : name;
      if (label.textContent !== text) label.textContent = text;
      label.classList.toggle('target', reach);
      put(label, x + 14, y + 8);
    });
    letters.forEach((letter, k) => {
      const at = scene.handles.letterAt(k);
      letter.hidden = !at;
      if (at) put(letter, at.x - 4, at.y - 9);
    });
    field();
  };
}

/** The size of the field, at the tip of its arrow, where neither the arrow nor the robot is. */
function makeFieldLabel(box: HTMLElement, robot: Robot, scene: RobotScene): () => void {
  const {field} = scene;
  if (!field) return () => {};
  const label = element('span', {class: 'field'});
  box.append(label);
  return () => {
    const {x, y} = scene.project(field.tip), untouched = robot.able && !robot.canUndo;
    const text = `field ${digits(field.size, 3)} mT${untouched ? ': drag me' : ''}`;
    if (label.textContent !== text) label.textContent = text;
    label.hidden = !field.visible;
    label.classList.toggle('above', y < scene.project(field.foot).y);
    put(label, Math.max(x, label.offsetWidth - 16), y);  // not out of the picture
  };
}
