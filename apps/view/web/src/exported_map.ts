import type {IkOptions} from './inverse';
import {KinematicMap, type MapDocument} from './map';

/** Results of softkin at some commands, for comparison. slopes: the directional derivatives of the outputs where input
    i moves by i + 1 times its range. */
export interface MapAnswers {
  commands: number[][]; outputs: number[][]; slopes: number[][]; outputScale: number[]; slopeScale: number[];
}

/** Returns '' where the map reproduces softkin's results, or else a description of the first difference. */
function compare(map: KinematicMap, answers: MapAnswers): string {
  const {inputs, outputs} = map;
  const differs = (found: number, wanted: number, scale: number): boolean => !(Math.abs(found - wanted) <= scale);
  for (const [n, commands] of answers.commands.entries()) {
    const found = map.fk(commands);
    if (!found) return `the map has no answer at [${commands}]`;
    for (const [q, {name}] of outputs.entries()) {
      const slope = inputs.reduce((sum, {low, high}, i) => sum + found.jacobian[q][i] * (i + 1) * (high - low), 0);
      if (differs(found.outputs[q], answers.outputs[n][q], 1e-12 * answers.outputScale[q]))
        return `${name} at [${commands}] is ${found.outputs[q]}, not ${answers.outputs[n][q]}`;
      if (differs(slope, answers.slopes[n][q], 1e-10 * answers.slopeScale[q]))
        return `slopes of ${name} at [${commands}]`;
    }
  }
  const outside = answers.commands[0].map((command, i) => i === 0 ? 2 * inputs[0].high - inputs[0].low : command);
  return map.fk(outside) ? 'commands out of range are not refused' : '';
}

/** Returns the exports of the module of an exported map (src/softkin/runs/map_export_js.cpp). */
export function exported(document: MapDocument, answers: MapAnswers) {
  const map = new KinematicMap(document);
  return {
    fk: (commands: ArrayLike<number>) => map.fk(commands),
    /** Inverse kinematics. marker: its number or name; start: by default the middles of the ranges. */
    ik(marker: number | string, target: ArrayLike<number>, start?: ArrayLike<number>, options?: IkOptions) {
      const number = typeof marker === 'string' ? map.markers.indexOf(marker) : marker;
      if (!(number in map.markers)) throw new RangeError(`the map has no marker ${marker}`);
      return map.lead(Array.from(target, (value, k) => ({output: 3 * number + k, value})), start, options);
    },
    vertices: map.vertices,
    shape: (commands: ArrayLike<number>) => map.shape(commands),
    check: () => compare(map, answers),
  };
}
