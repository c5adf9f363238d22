import {draggedField} from './field';
import type {Robot} from './robot';
import type {RobotScene} from './scene';

const grabPx = {mouse: 14, touch: 34};

/** A drag in progress. marker: the marker that it moves, or null; move: follows the pointer. */
interface Drag { marker: number | null; move(x: number, y: number): void }
/** A point that can be dragged, and its distance from the pointer [px]. */
interface Grip { distance: number; begin(): Drag }

/** Lets the pointer drag a marker, a target out of reach, one of a marker's arrows, or the tip of the field. */
export function makeDrag(canvas: HTMLCanvasElement, robot: Robot, scene: RobotScene): void {
  let drag: Drag | null = null;
  const find = (event: PointerEvent): Drag | null => {
    const touch = event.pointerType === 'touch', {offsetX: x, offsetY: y} = event;
    const radius = touch ? grabPx.touch : grabPx.mouse;
    const near = gripsOf(robot, scene, x, y).filter(({distance}) => distance < radius);
    const best = near.sort((a, b) => a.distance - b.distance).at(0), axis = scene.handles.under(x, y, touch);
    if (axis < 0 || (best && best.distance < 8)) return best?.begin() ?? null;
    return dragAxis(robot, scene, axis, x, y);
  };
  canvas.addEventListener('pointerdown', (event) => {
    drag = event.button === 0 && event.isPrimary ? find(event) : null;
    if (!drag) return;
    event.stopImmediatePropagation();  // keeps the camera from turning
    robot.selected = drag.marker ?? robot.selected;
    robot.remember();
    if (drag.marker === null) scene.lockCamera(true);
    else scene.keepCamera();
    canvas.setPointerCapture(event.pointerId);
    canvas.classList.add('held');
  }, {capture: true});
  canvas.addEventListener('pointermove', (event) => {
    if (!drag) {
      if (event.pointerType === 'mouse') canvas.classList.toggle('over', find(event) !== null);
      return;
    }
    event.stopImmediatePropagation();
    drag.move(event.offsetX, event.offsetY);
  }, {capture: true});
  const endDrag = () => {
    drag = null;
    scene.lockCamera(false);
    canvas.classList.remove('held');
  };
  canvas.addEventListener('pointerup', endDrag);
  canvas.addEventListener('pointercancel', endDrag);
}

/** Returns all points that can be dragged; each keeps its offset from the pixel (x, y) while it is dragged. */
function gripsOf(robot: Robot, scene: RobotScene, x: number, y: number): Grip[] {
  const grip = (at: number[], begin: (dx: number, dy: number) => Drag): Grip => {
    const p = scene.project(at);
    return {distance: Math.hypot(p.x - x, p.y - y), begin: () => begin(p.x - x, p.y - y)};
  };
  const places = robot.pose.markers.map((at, marker) => ({marker, at}));
  if (robot.target) places.push(robot.target);
  const grips = places.filter(({marker}) => robot.canReach(marker)).map(({marker, at}) =>
    grip(at, (dx, dy) => ({
      marker, move: (to, down) => robot.reach(marker, scene.under(to + dx, down + dy, at)),
    })));
  if (scene.field?.visible && robot.able)
    grips.push(grip(scene.field.tip, (dx, dy) => dragField(robot, scene, dx, dy)));
  return grips;
}

/** Moves the tip of the field perpendicular to the line of sight; the commands follow within their ranges. */
function dragField(robot: Robot, scene: RobotScene, dx: number, dy: number): Drag {
  const start = robot.commands.slice(), from = scene.field?.tip ?? [0, 0, 0], sight = scene.directionTo(from);
  const perMm = 1 / (scene.field?.mmPerUnit ?? 1), {actuators} = robot.document;
  return {marker: null, move: (x, y) => {
    const change = scene.under(x + dx, y + dy, from, sight).map((value, k) => (value - from[k]) * perMm);
    robot.command(draggedField(actuators, start, change, sight));
  }};
}

function dragAxis(robot: Robot, scene: RobotScene, axis: number, x: number, y: number): Drag {
  const marker = robot.selected, start = placeOfHandles(robot) ?? [0, 0, 0];
  return {marker, move: (to, down) => {
    const distance = scene.handles.along(axis, to - x, down - y);
    robot.reach(marker, start.map((value, k) => k === axis ? value + distance : value));
  }};
}

/** Returns the position of the arrows: the target, or else the selected marker; null where there are none. */
export function placeOfHandles(robot: Robot): number[] | null {
  if (!robot.canReach(robot.selected)) return null;
  return robot.target?.marker === robot.selected ? robot.target.at : robot.pose.markers[robot.selected];
}
