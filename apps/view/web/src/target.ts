import type {Robot} from './robot';
import {byId, digits, element, mm, plain} from './text';
import {drives} from './words';

/** The largest error of a target that counts as reached after a drag [mm]. */
const toleranceMm = 0.05;

function atLimits(robot: Robot): string {
  const names = robot.document.actuators.flatMap(({name, low, high}, i) => {
    const command = robot.commands[i], tolerance = 1e-6 * (high - low);
    if (command <= low + tolerance) return [`${plain(name)} at its lowest`];
    return command >= high - tolerance ? [`${plain(name)} at its highest`] : [];
  });
  return names.length ? ` Limits met: ${names.join(', ')}.` : '';
}

/** Explains why a target is not reached. */
function whyNot(robot: Robot): string {
  const count = robot.document.actuators.filter(drives).length, limits = atLimits(robot);
  if (robot.target?.why) return ` ${robot.target.why}`;
  if (limits) return limits;
  if (count >= 3) return ' No small change of the commands brings it nearer.';
  const [s, range] = count > 1 ? ['s', 'surface'] : ['', 'curve'];
  return ` With ${count} actuator${s} it can only move on a ${range}.`;
}

export function targetWords(robot: Robot): {text: string; bad: boolean} {
  const {target, document} = robot;
  if (!target) return {text: '', bad: false};
  const name = plain(document.markers[target.marker].name), {errorMm} = target;
  if (errorMm === null) return {text: `softkin is searching for commands that bring ${name} there …`, bad: false};
  if (target.why.startsWith('not reached')) return {text: `${name} ${target.why}.`, bad: true};
  if (!target.reached && errorMm > toleranceMm)
    return {text: `Out of reach: ${name} is ${mm(errorMm)} mm from its target.${whyNot(robot)}`, bad: true};
  const distance = errorMm < 1e-3 ? 'less than 0.001' : digits(errorMm, 2);
  return {text: `Reached: ${name} is ${distance} mm from its target.`, bad: false};
}

/** Shows the target as numbers that can be typed; returns the function that updates them. */
export function makeTarget(robot: Robot): () => void {
  const {markers, live} = robot.document, box = byId('target'), error = byId('error');
  const able = markers.map((_, i) => i).filter((i) =>
    live !== null ? !markers[i].body && !robot.isEstimating : robot.canReach(i));
  if (!able.length) return () => {};
  robot.selected = able[0];
  byId('target-section').hidden = false;
  byId('explain-target').textContent = 'Drag the round marker or one of its arrows in the picture, or type a place ' +
    `in mm: ${live ? 'softkin' : 'the page'} finds the commands that lead there.`;
  const choose = element('select', {'aria-label': 'Marker'},
    ...able.map((i) => element('option', {value: i}, plain(markers[i].name))));
  const fields = ['x', 'y', 'z'].map((axis) =>
    element('input', {type: 'number', step: 'any', 'aria-label': `Target ${axis} in mm`}));
  const axes = fields.flatMap((field, k) => [element('label', {'aria-hidden': 'true'}, 'xyz'[k]), field]);
  if (able.length > 1) box.append(choose);
  box.append(element('div', {class: 'fields'}, ...axes, element('span', {'aria-hidden': 'true'}, 'mm')));
  for (const field of fields) field.addEventListener('change', () => {
    const at = fields.map((one) => Number(one.value));
    if (fields.some((one) => one.value === '') || !at.every(Number.isFinite)) return robot.onChange();
    robot.remember();
    robot.reach(robot.selected, at);
  });
  choose.addEventListener('change', () => {
    robot.selected = Number(choose.value);
    robot.onChange();
  });
  return () => {
    if (robot.target) robot.selected = robot.target.marker;
    choose.value = String(robot.selected);
    const at = robot.target?.at ?? robot.pose.markers[robot.selected];
    fields.forEach((field, k) => {
      field.disabled = !robot.canReach(robot.selected);
      if (document.activeElement !== field) field.value = at[k].toFixed(2).replace(/^-(0\.00)$/, '$1');
    });
    const {text, bad} = targetWords(robot);
    error.textContent = text;
    error.className = bad ? 'bad' : 'good';
  };
}
