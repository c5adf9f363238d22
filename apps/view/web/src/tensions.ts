import type {Robot} from './robot';
import type {RobotScene} from './scene';
import {colourAt} from './colours';
import {digits, element} from './text';

/** Colours the cables by their tensions, with a legend in the box; returns the function that updates both. */
export function makeTensions(robot: Robot, scene: RobotScene, box: HTMLElement, somePoses: number[][]): () => void {
  const {cables, actuators} = robot.document;
  if (!cables.length) return () => {};
  const of = (loads: (number | null)[]) => cables.map(({actuator}) =>
    actuators[actuator].load_unit ? loads[actuator] : null);
  let highest = 0;
  const extendRange = (loads: (number | null)[]) => {
    highest = Math.max(highest, ...of(loads).map((load) => load ?? 0));
  };
  for (const step of robot.steps) extendRange(step.loads);
  for (const commands of somePoses) extendRange(robot.evaluateMap(commands)?.loads ?? []);
  const bar = element('canvas', {width: 100, height: 1, 'aria-hidden': 'true'}), maximum = element('span');
  const legend = element('p', {class: 'tension'}, 'Tension of the cables: 0', bar, maximum);
  const context = bar.getContext('2d');
  box.append(legend);
  return () => {
    for (let i = 0; context && i < bar.width; ++i) {
      context.fillStyle = `rgb(${colourAt(i / (bar.width - 1), false).join()})`;
      context.fillRect(i, 0, 1, 1);
    }
    extendRange(robot.pose.loads);
    maximum.textContent = `${digits(highest, 3)} N`;
    legend.hidden = highest <= 0;
    scene.setTensions(of(robot.pose.loads).map((load) =>
      load === null || highest <= 0 ? null : Math.max(load, 0) / highest));
  };
}

/** Returns the corners of the command ranges of a map, from which the camera and the colours are set. */
export function cornersOf(robot: Robot): number[][] {
  const {actuators} = robot.document, count = robot.map ? 2 ** Math.min(actuators.length, 6) : 0;
  return Array.from({length: count}, (_, corner) =>
    actuators.map(({low, high}, i) => (corner >> i) & 1 ? high : low));
}
