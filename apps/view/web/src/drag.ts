import {draggedField} from './field';
import type {Robot} from './robot';
import type {RobotScene} from './scene';

const grabPx = {mouse: 14, touch: 34};

/** What a pointer holds, and what follows it. marker: it belongs to; null: none. */
interface Hold { marker: number | null; move(x: number, y: number): void }
/** A place that can be dragged, and how far it is from the pointer. */
interface Grip { far: number; hold(): Hold }

/** A marker, the target out of its reach, an arrow, or the tip of the field is taken with the pointer and dragged. */
export function makeDrag(canvas: HTMLCanvasElement, robot: Robot, scene: RobotScene): void {
  let hold: Hold | null = null;
  const find = (event: PointerEvent): Hold | null => {
    const touch = event.pointerType === 'touch', {offsetX: x, offsetY: y} = event;
    const near = gripsOf(robot, scene, x, y).filter(({far}) => far < (touch ? grabPx.touch : grabPx.mouse));
    const best = near.sort((a, b) => a.far - b.far).at(0), axis = scene.handles.under(x, y, touch);
    if (axis < 0 || (best && best.far < 8)) return best?.hold() ?? null;
    return holdAxis(robot, scene, axis, x, y);
  };
  canvas.addEventListener('pointerdown', (event) => {
    hold = event.button === 0 && event.isPrimary ? find(event) : null;
    if (!hold) return;
    event.stopImmediatePropagation();  // the camera stays
    robot.selected = hold.marker ?? robot.selected;
    robot.remember();
    if (hold.marker === null) scene.holdEye(true);
    else scene.keepEye();
    canvas.setPointerCapture(event.pointerId);
    canvas.classList.add('held');
  }, {capture: true});
  canvas.addEventListener('pointermove', (event) => {
    if (!hold) {
      if (event.pointerType === 'mouse') canvas.classList.toggle('over', find(event) !== null);
      return;
    }
    event.stopImmediatePropagation();
    hold.move(event.offsetX, event.offsetY);
  }, {capture: true});
  const letGo = () => {
    hold = null;
    scene.holdEye(false);
    canvas.classList.remove('held');
  };
  canvas.addEventListener('pointerup', letGo);
  canvas.addEventListener('pointercancel', letGo);
}

/** Places under or near a pixel, each held where the pointer took it. */
function gripsOf(robot: Robot, scene: RobotScene, x: number, y: number): Grip[] {
  const grip = (at: number[], hold: (dx: number, dy: number) => Hold): Grip => {
    const p = scene.project(at);
    return {far: Math.hypot(p.x - x, p.y - y), hold: () => hold(p.x - x, p.y - y)};
  };
  const places = robot.pose.markers.map((at, marker) => ({marker, at}));
  if (robot.target) places.push(robot.target);
  const grips = places.filter(({marker}) => robot.canReach(marker)).map(({marker, at}) =>
    grip(at, (dx, dy) => ({
      marker, move: (to, down) => robot.reach(marker, scene.under(to + dx, down + dy, at)),
    })));
  if (scene.field?.visible && robot.able)
    grips.push(grip(scene.field.tip, (dx, dy) => holdField(robot, scene, dx, dy)));
  return grips;
}

/** The tip of the field moves across the way from the eye, and the commands with it as far as they can. */
function holdField(robot: Robot, scene: RobotScene, dx: number, dy: number): Hold {
  const start = robot.commands.slice(), from = scene.field?.tip ?? [0, 0, 0], eye = scene.wayTo(from);
  const perMm = 1 / (scene.field?.mmPerUnit ?? 1), {actuators} = robot.document;
  return {marker: null, move: (x, y) => {
    const change = scene.under(x + dx, y + dy, from, eye).map((value, k) => (value - from[k]) * perMm);
    robot.command(draggedField(actuators, start, change, eye));
  }};
}

function holdAxis(robot: Robot, scene: RobotScene, axis: number, x: number, y: number): Hold {
  const marker = robot.selected, start = placeOfHandles(robot) ?? [0, 0, 0];
  return {marker, move: (to, down) => {
    const far = scene.handles.along(axis, to - x, down - y);
    robot.reach(marker, start.map((value, k) => k === axis ? value + far : value));
  }};
}

/** Where the arrows stand: at the target, else at the marker that is chosen; null: nowhere. */
export function placeOfHandles(robot: Robot): number[] | null {
  if (!robot.canReach(robot.selected)) return null;
  return robot.target?.marker === robot.selected ? robot.target.at : robot.pose.markers[robot.selected];
}
