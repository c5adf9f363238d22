import {robotName} from './document';
import {type Box, boxAt, place, type Spot} from './labels';
import {plusMinus} from './estimate';
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

/** Shows the robot's name, its actuators and how to use the page. */
export function showHeading(robot: Robot): void {
  const name = plain(robotName(robot.document)), {live} = robot.document;
  document.title = `${name} – softkin`;
  byId('robot').textContent = name;
  byId('about-robot').textContent =
    `A soft robot moved by ${partsOf(robot)}. Its shape ${live ? 'is' : 'was'} computed; lengths are in mm.`;
  const movable = live || robot.map, field = largestField(robot.document.actuators) !== null;
  const canDrag = robot.document.markers.some((marker, i) => live ? !marker.body : robot.canReach(i));
  const marked = canDrag ? [`the round marker${field ? ', its arrows' : ' or its arrows'}`] : [];
  const drag = [...marked, ...(field ? ['the tip of the field'] : [])].join(' or ');
  byId('hint').textContent = robot.isEstimating
    ? 'Type the readings: softkin estimates the forces, and the shape follows. Drag the picture to turn the view. ' +
      'Pale: the unloaded reference shape.'
    : movable
    ? `Move a slider${drag && `, or drag ${drag}`}: the robot follows. ` +
      'Drag the background to turn the view. Pale: the unloaded reference shape.'
    : 'Play the steps, or drag the picture to turn the view. Pale: the unloaded reference shape.';
}

/** Explains the sliders in the present state. live: null where no softkin runs. */
export function explainSliders(robot: Robot, live: LiveState | null): void {
  const {actuators, map} = {actuators: robot.document.actuators, map: robot.map}, box = byId('explain-actuators');
  const off = live ? whyOff(live) : '', a = actuators.length > 1 ? 'a' : 'the';
  const each = actuators.length > 1 ? 'each' : 'the';
  const text = off || (robot.isEstimating ? `The command of ${each} actuator when the readings were taken.`
    : map || live ? `Drag ${a} slider or type a number: the robot follows.`
    : 'The command of each actuator at this step. Play the steps below the picture.');
  if (box.textContent === text) return;
  box.textContent = text;
  box.classList.toggle('off', off !== '');
}

function moveTo(label: HTMLElement, x: number, y: number): void {
  label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
}

/** Creates the labels of markers and arrows over the picture; returns the function that places them. */
export function makeLabels(robot: Robot, scene: RobotScene): () => void {
  const {markers} = robot.document, box = byId('labels');
  const labels = markers.map(() => element('span')), letters = [0, 1, 2].map((k) => element('b', {}, 'xyz'[k]));
  box.append(...labels, ...letters);
  const field = makeFieldLabel(box, robot, scene), forces = makeForceLabels(box, robot, scene);
  let hasDragged = false;
  const before: number[] = [];
  return () => {
    hasDragged ||= robot.target !== null;
    const spots = markers.map((_, i) => scene.project(robot.pose.markers[i]));
    labels.forEach((label, i) => {
      const name = plain(markers[i].name), reach = robot.canReach(i);
      const text = reach && !hasDragged && i === robot.selected ? `${name}: drag me` : name;
      if (label.textContent !== text) label.textContent = text;
      label.classList.toggle('target', reach);
    });
    const around = letters.flatMap((letter, k): Box[] => {
      const at = scene.handles.letterAt(k);
      letter.hidden = !at;
      if (!at) return [];
      moveTo(letter, at.x - 4, at.y - 9);
      return [boxAt({x: at.x - 4, y: at.y - 9}, letter.offsetWidth, letter.offsetHeight)];
    });
    field();
    forces();
    placeLabels(box, labels, spots, around, before, robot.selected);
  };
}

const radiusPx = 6;  // of a marker

/** Places the labels next to their markers, the selected one first, so that none covers another label, a marker or
    another text on the picture. */
function placeLabels(box: HTMLElement, labels: HTMLElement[], spots: Spot[], letters: Box[], before: number[],
                  selected: number): void {
  const {left, top, width, height} = box.getBoundingClientRect();
  const others = ['#hint', '#colour-bar', '#state', '#grid-size', '#labels .field', '#labels .force']
    .flatMap((name) => [...document.querySelectorAll(name)]).flatMap((each): Box[] => {
    const at = each.getBoundingClientRect();
    return at.width ? [boxAt({x: at.left - left, y: at.top - top}, at.width, at.height)] : [];
  });
  const balls = spots.map(({x, y}) => boxAt({x: x - radiusPx, y: y - radiusPx}, 2 * radiusPx, 2 * radiusPx));
  const order = [...labels.keys()].sort((a, b) => Number(b === selected) - Number(a === selected) || a - b);
  const choices = order.map((i) => before[i] ?? 0);
  const found = place(order.map((i) => ({at: spots[i], width: labels[i].offsetWidth, height: labels[i].offsetHeight})),
                      [...letters, ...others, ...balls], {left: 0, top: 0, right: width, bottom: height}, choices);
  order.forEach((i, k) => {
    const at = found[k], label = labels[i];
    before[i] = choices[k];
    label.dataset.at = `${spots[i].x.toFixed(1)},${spots[i].y.toFixed(1)}`;
    label.classList.toggle('crowded', !at);
    if (at) moveTo(label, at.x, at.y);
  });
}

/** Creates the label of the field's magnitude at the tip of its arrow, beside the arrow and the robot. */
function makeFieldLabel(box: HTMLElement, robot: Robot, scene: RobotScene): () => void {
  const {field} = scene;
  if (!field) return () => {};
  const label = element('span', {class: 'field'});
  box.append(label);
  return () => {
    const {x, y} = scene.project(field.tip), isUnmoved = robot.able && !robot.canUndo;
    const text = `field ${digits(field.size, 3)} mT${isUnmoved ? ': drag me' : ''}`;
    if (label.textContent !== text) label.textContent = text;
    label.hidden = !field.visible;
    label.classList.toggle('above', y < scene.project(field.foot).y);
    moveTo(label, Math.max(x, label.offsetWidth - 16), y);  // stays inside the picture
  };
}

/** Creates the labels of the estimated forces' magnitudes at the tips of their arrows. */
function makeForceLabels(box: HTMLElement, robot: Robot, scene: RobotScene): () => void {
  const labels: HTMLElement[] = [];
  return () => {
    const {arrows, group} = scene.forces, estimated = robot.estimate?.forces ?? [];
    while (labels.length < estimated.length) box.append(labels[labels.push(element('span', {class: 'force'})) - 1]);
    labels.forEach((label, i) => {
      label.hidden = i >= estimated.length || i >= arrows.length || !group.visible;
      if (label.hidden) return;
      const {force_N: force, name, deviation_N: deviation} = estimated[i], {foot, tip} = arrows[i];
      const text = `${plain(name)} ${plusMinus(Math.hypot(...force), deviation, 'N')}`;
      if (label.textContent !== text) label.textContent = text;
      const from = scene.project(foot), to = scene.project(tip), {clientWidth, clientHeight} = box;
      const x = to.x + (to.x < from.x ? -label.offsetWidth - 12 : 12), y = to.y + (to.y < from.y ? -26 : 6);
      moveTo(label, Math.min(Math.max(x, 0), clientWidth - label.offsetWidth),
          Math.min(Math.max(y, 0), clientHeight - label.offsetHeight));
    });
  };
}
