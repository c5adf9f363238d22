import type {Robot} from './robot';
import type {RobotScene} from './scene';

const grabPx = {mouse: 14, touch: 34};

/** What a pointer holds: a marker (axis: -1, moved on the plane of the screen), or an arrow of it. */
interface Hold { marker: number; axis: number; start: number[]; x: number; y: number; offset: {x: number; y: number} }

/** A marker, the target out of its reach, or an arrow is taken with the pointer and dragged. */
export function makeDrag(canvas: HTMLCanvasElement, robot: Robot, scene: RobotScene): void {
  let hold: Hold | null = null;
  const find = (event: PointerEvent): Hold | null => {
    const touch = event.pointerType === 'touch', {offsetX: x, offsetY: y} = event, none = {x: 0, y: 0};
    let best: Hold | null = null, least = touch ? grabPx.touch : grabPx.mouse;
    const places = robot.pose.markers.map((at, marker) => ({marker, at}));
    if (robot.target) places.push(robot.target);
    for (const {marker, at} of places) {
      const p = scene.project(at), far = Math.hypot(p.x - x, p.y - y);
      if (!robot.canReach(marker) || !(far < least)) continue;
      least = far;
      best = {marker, axis: -1, start: at, x, y, offset: {x: p.x - x, y: p.y - y}};
    }
    const axis = scene.handles.under(x, y, touch);
    if (axis < 0 || (best && least < 8)) return best;
    return {marker: robot.selected, axis, start: placeOfHandles(robot) ?? [0, 0, 0], x, y, offset: none};
  };
  canvas.addEventListener('pointerdown', (event) => {
    hold = event.button === 0 && event.isPrimary ? find(event) : null;
    if (!hold) return;
    event.stopImmediatePropagation();  // the camera stays
    robot.selected = hold.marker;
    robot.remember();
    scene.keepEye();
    canvas.setPointerCapture(event.pointerId);
    canvas.classList.add('held');
  }, {capture: true});
  canvas.addEventListener('pointermove', (event) => {
    if (!hold) {
      if (event.pointerType === 'mouse') canvas.classList.toggle('over', find(event) !== null);
      return;
    }
    event.stopImmediatePropagation();
    const {marker, axis, start, x, y, offset} = hold;
    if (axis < 0) {
      robot.reach(marker, scene.under(event.offsetX + offset.x, event.offsetY + offset.y, start));
      return;
    }
    const far = scene.handles.along(axis, event.offsetX - x, event.offsetY - y);
    robot.reach(marker, start.map((value, k) => k === axis ? value + far : value));
  }, {capture: true});
  const letGo = () => {
    hold = null;
    canvas.classList.remove('held');
  };
  canvas.addEventListener('pointerup', letGo);
  canvas.addEventListener('pointercancel', letGo);
}

/** Where the arrows stand: at the target, else at the marker that is chosen; null: nowhere. */
export function placeOfHandles(robot: Robot): number[] | null {
  if (!robot.canReach(robot.selected)) return null;
  return robot.target?.marker === robot.selected ? robot.target.at : robot.pose.markers[robot.selected];
}
