import {float32, float64, int16} from './base64';
import {type Goal, type IkOptions, type IkResult, inverse} from './inverse';

export interface MapInput { name: string; unit: string; low: number; high: number }
export interface MapOutput { name: string; unit: string; accuracy: number; largestError: number; meanError: number }
export interface MapCable { input: number; command: number; tension: number; ratio: number }
export interface MapChecked {
  points: number; outside: number; equilibria: number; shapeLargestErrorMm?: number; shapeMeanErrorMm?: number;
}
export interface PackedSums {
  size: number; highest: number[]; cells: number[]; terms: number[]; runs: number[]; coefficients: string;
}
export interface MapTables {
  pieces: number[]; variables: number[][]; roots: number[]; nodes: number[][]; cables: MapCable[];
  boxes: number[][][]; outputs: PackedSums; modes: PackedSums;
}

/** The tables of a map in pages and in modules of `softkin map export --js`; in a page, shapes are of the surface. */
export interface MapDocument {
  name: string; inputs: MapInput[]; outputs: MapOutput[]; markers: string[]; checked: MapChecked; tables: MapTables;
  shapeTables?: {mean: string; units: number[]; modes: string} | null;
}

type Sums = Omit<PackedSums, 'coefficients'> & {coefficients: Float64Array};
interface Place { piece: number; cell: number }
export interface Forward { outputs: number[]; jacobian: number[][] }

/** Returns the Chebyshev polynomials up to a degree and their derivatives, n U_(n-1). */
function chebyshev(x: number, highest: number): {values: number[]; slopes: number[]} {
  const values = [1, x], slopes = [0, 1];
  for (let n = 2, before = 1, second = 2 * x; n <= highest; ++n) {
    values.push(2 * x * values[n - 1] - values[n - 2]);
    slopes.push(n * second);
    [before, second] = [second, 2 * x * second - before];
  }
  return {values, slopes};
}

/** Evaluates the polynomials of a cell at x, from -1 to 1. slopes: receives the derivatives by each x, or null. */
function evaluateSums(sums: Sums, cell: number, x: number[], values: number[], slopes: number[][] | null): void {
  const n = x.length, last = n - 1, {size, runs, coefficients} = sums;
  const of = x.map((value, j) => chebyshev(value, sums.highest[cell * n + j]));
  const weights = new Array<number>(last);
  let row = sums.terms[cell + 1] * size;
  values.fill(0);
  if (slopes) for (const slope of slopes) slope.fill(0);
  for (let r = sums.cells[cell + 1]; r-- > sums.cells[cell];) {
    const run = r * n, count = runs[run + last];  // degrees of all but the last; number of terms
    let weight = 1;
    for (let j = 0; j < last; ++j) weight *= of[j].values[runs[run + j]];
    for (let i = 0; slopes && i < last; ++i) {
      weights[i] = of[i].slopes[runs[run + i]];
      for (let j = 0; j < last; ++j) if (j !== i) weights[i] *= of[j].values[runs[run + j]];
    }
    row -= count * size;
    for (let q = 0; q < size; ++q) {
      let sum = 0, derivative = 0;
      for (let k = count; k-- > 0;) {
        const coefficient = coefficients[row + k * size + q];
        sum += of[last].values[k] * coefficient;
        derivative += of[last].slopes[k] * coefficient;
      }
      values[q] += weight * sum;
      if (!slopes) continue;
      for (let i = 0; i < last; ++i) slopes[i][q] += weights[i] * sum;
      slopes[last][q] += weight * derivative;
    }
  }
}

/** The kinematics of a robot as piecewise polynomials. Its methods return null for commands outside the map. */
export class KinematicMap {
  readonly inputs: MapInput[];
  readonly outputs: MapOutput[];
  readonly markers: string[];
  readonly checked: MapChecked;
  readonly vertices: number;  // number of vertices of its shape
  private readonly tables: MapTables;
  private readonly outputSums: Sums;
  private readonly modeSums: Sums;
  private readonly mean: Float32Array;
  private readonly units: number[];
  private readonly modes: Int16Array;  // stored one after the other

  constructor(map: MapDocument) {
    ({inputs: this.inputs, outputs: this.outputs, markers: this.markers, checked: this.checked, tables: this.tables} =
      map);
    this.outputSums = {...map.tables.outputs, coefficients: float64(map.tables.outputs.coefficients)};
    this.modeSums = {...map.tables.modes, coefficients: float64(map.tables.modes.coefficients)};
    this.mean = map.shapeTables ? float32(map.shapeTables.mean) : new Float32Array();
    this.vertices = this.mean.length / 3;
    this.units = map.shapeTables?.units ?? [];
    this.modes = map.shapeTables ? int16(map.shapeTables.modes) : new Int16Array();
    if (this.modes.length < this.mean.length * this.units.length)
      throw new RangeError('the map has too few modes of the shape');
  }

  /** Scales the commands to -1 to 1 over the box of a cell. */
  private scaled(place: Place, commands: ArrayLike<number>): number[] {
    return this.tables.variables[place.piece].map((input, j) => {
      const [low, high] = this.tables.boxes[place.cell][j];
      return high > low ? (2 * commands[input] - low - high) / (high - low) : 0;
    });
  }

  private cellOf(piece: number, commands: ArrayLike<number>): number {
    const {nodes, roots} = this.tables;
    let node = nodes[roots[piece]];
    while (node.length > 1) node = nodes[commands[node[0]] < node[1] ? node[2] : node[3]];
    return node[0];
  }

  /** Returns the cable that violates its constraint most, or -1: an active cable whose tension is negative (these come
      first), or a slack cable that is longer than its command. Violations within the map's accuracy do not count while
      the active set is cycling, or where the map has no piece for the changed active set. */
  private mostViolatedCable(active: number, isCycling: boolean, commands: ArrayLike<number>, values: number[]): number {
    let cable = -1, isNegative = false, worst = 0;
    this.tables.cables.forEach(({input, command, tension, ratio}, c) => {
      const isActive = ((active >> c) & 1) === 1;
      const violation = isActive ? -values[tension]
        : values[ratio] - (input < 0 ? command : commands[input]) * (1 + 1e-12);
      const isLenient = isCycling || this.tables.pieces[active ^ (1 << c)] < 0;
      const by = violation - (isLenient ? this.outputs[isActive ? tension : ratio].accuracy : 0);
      if (!(by > 0) || (isNegative && !isActive) || (isNegative === isActive && by <= worst)) return;
      [cable, worst, isNegative] = [c, by, isActive];
    });
    return cable;
  }

  /** Finds the piece and cell of the commands by an active-set iteration that starts with all cables active, and
      evaluates its outputs. */
  private find(commands: ArrayLike<number>, values: number[], slopes: number[][] | null): Place | null {
    const {inputs, tables} = this;
    if (commands.length !== inputs.length || !inputs.every((_, i) => typeof commands[i] === 'number'))
      throw new TypeError(`the map takes ${inputs.length} numbers`);
    if (!inputs.every(({low, high}, i) => commands[i] >= low && commands[i] <= high)) return null;
    let active = (1 << tables.cables.length) - 1;
    for (let change = 0; change <= 4 * tables.cables.length; ++change) {
      const place: Place = {piece: tables.pieces[active], cell: -1};
      if (place.piece >= 0) place.cell = this.cellOf(place.piece, commands);
      if (place.cell < 0) return null;
      evaluateSums(this.outputSums, place.cell, this.scaled(place, commands), values, slopes);
      const cable = this.mostViolatedCable(active, change >= 2 * tables.cables.length, commands, values);
      if (cable < 0) return place;
      active ^= 1 << cable;
    }
    return null;
  }

  /** Returns the outputs and their derivatives by the commands: jacobian[output][input]. */
  fk(commands: ArrayLike<number>): Forward | null {
    const {inputs, outputs, tables} = this;
    const values = new Array<number>(outputs.length).fill(0);
    const slopes = inputs.map(() => new Array<number>(outputs.length).fill(0));
    const place = this.find(commands, values, slopes);
    if (!place) return null;
    const jacobian = outputs.map(() => new Array<number>(inputs.length).fill(0));
    tables.variables[place.piece].forEach((input, j) => {
      const [low, high] = tables.boxes[place.cell][j];
      if (high > low) for (let q = 0; q < outputs.length; ++q) jacobian[q][input] = 2 / (high - low) * slopes[j][q];
    });
    return {outputs: values, jacobian};
  }

  /** Returns x, y, z of each vertex [mm]. */
  shape(commands: ArrayLike<number>): Float32Array | null {
    const place = this.find(commands, new Array<number>(this.outputs.length).fill(0), null);
    if (!place || !this.vertices) return null;
    const amplitudes = new Array<number>(this.modeSums.size).fill(0), positions = Float32Array.from(this.mean);
    evaluateSums(this.modeSums, place.cell, this.scaled(place, commands), amplitudes, null);
    amplitudes.forEach((amplitude, m) => {
      const scale = this.units[m] * amplitude, first = m * positions.length;
      for (let k = 0; k < positions.length; ++k) positions[k] += scale * this.modes[first + k];
    });
    return positions;
  }

  /** Inverse kinematics: returns commands at which outputs come nearest to goals, near the start (by default the
      middles of the ranges); where that does not reach the goals, other initial guesses are tried. Null where the
      start is outside the map. */
  lead(goals: Goal[], start?: ArrayLike<number>, options: IkOptions = {}): IkResult | null {
    return inverse(this, goals, start, options);
  }
}
