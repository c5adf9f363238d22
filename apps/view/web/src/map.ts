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

/** The tables of a map, as in pages and modules of `softkin map export --js`; shapes of a page are of the surface. */
export interface MapDocument {
  name: string; inputs: MapInput[]; outputs: MapOutput[]; markers: string[]; checked: MapChecked; tables: MapTables;
  shapeTables?: {mean: string; units: number[]; modes: string} | null;
}

type Sums = Omit<PackedSums, 'coefficients'> & {coefficients: Float64Array};
interface Place { piece: number; cell: number }
export interface Forward { outputs: number[]; jacobian: number[][] }

/** Chebyshev polynomials up to a degree, and their slopes, n U_(n-1). */
function chebyshev(x: number, highest: number): {values: number[]; slopes: number[]} {
  const values = [1, x], slopes = [0, 1];
  for (let n = 2, before = 1, second = 2 * x; n <= highest; ++n) {
    values.push(2 * x * values[n - 1] - values[n - 2]);
    slopes.push(n * second);
    [before, second] = [second, 2 * x * second - before];
  }
  return {values, slopes};
}

/** Sums of a cell at x, from -1 to 1; slopes: by each x, or null. */
function addUp(sums: Sums, cell: number, x: number[], values: number[], slopes: number[][] | null): void {
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
      let sum = 0, sloped = 0;
      for (let k = count; k-- > 0;) {
        const coefficient = coefficients[row + k * size + q];
        sum += of[last].values[k] * coefficient;
        sloped += of[last].slopes[k] * coefficient;
      }
      values[q] += weight * sum;
      if (!slopes) continue;
      for (let i = 0; i < last; ++i) slopes[i][q] += weights[i] * sum;
      slopes[last][q] += weight * sloped;
    }
  }
}

/** Where a robot goes, in closed form. Commands outside the ranges or the map: null. */
export class KinematicMap {
  readonly inputs: MapInput[];
  readonly outputs: MapOutput[];
  readonly markers: string[];
  readonly checked: MapChecked;
  readonly vertices: number;  // of its shape
  private readonly tables: MapTables;
  private readonly outputSums: Sums;
  private readonly modeSums: Sums;
  private readonly mean: Float32Array;
  private readonly units: number[];
  private readonly modes: Int16Array;  // one after the other

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
      throw new RangeError('the map lacks modes of the shape');
  }

  /** The numbers from -1 to 1 over the box of a cell. */
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

  /** All cables are taut at first: one that would push goes slack, one that is longer than it may be is taken up; the
      one that is most wrong first. circles, or no piece: less than the accuracy is not wrong. */
  private wrongCable(taut: number, circles: boolean, commands: ArrayLike<number>, values: number[]): number {
    let wrong = -1, pushes = false, worst = 0;
    this.tables.cables.forEach(({input, command, tension, ratio}, c) => {
      const holds = ((taut >> c) & 1) === 1;
      const excess = holds ? -values[tension] : values[ratio] - (input < 0 ? command : commands[input]) * (1 + 1e-12);
      const lenient = circles || this.tables.pieces[taut ^ (1 << c)] < 0;
      const by = excess - (lenient ? this.outputs[holds ? tension : ratio].accuracy : 0);
      if (!(by > 0) || (pushes && !holds) || (pushes === holds && by <= worst)) return;
      [wrong, worst, pushes] = [c, by, holds];
    });
    return wrong;
  }

  private find(commands: ArrayLike<number>, values: number[], slopes: number[][] | null): Place | null {
    const {inputs, tables} = this;
    if (commands.length !== inputs.length || !inputs.every((_, i) => typeof commands[i] === 'number'))
      throw new TypeError(`the map takes ${inputs.length} numbers`);
    if (!inputs.every(({low, high}, i) => commands[i] >= low && commands[i] <= high)) return null;
    let taut = (1 << tables.cables.length) - 1;
    for (let change = 0; change <= 4 * tables.cables.length; ++change) {
      const place: Place = {piece: tables.pieces[taut], cell: -1};
      if (place.piece >= 0) place.cell = this.cellOf(place.piece, commands);
      if (place.cell < 0) return null;
      addUp(this.outputSums, place.cell, this.scaled(place, commands), values, slopes);
      const wrong = this.wrongCable(taut, change >= 2 * tables.cables.length, commands, values);
      if (wrong < 0) return place;
      taut ^= 1 << wrong;
    }
    return null;
  }

  /** Outputs, and by how much each changes per command: jacobian[output][input]. */
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

  /** x, y, z of each vertex [mm]. */
  shape(commands: ArrayLike<number>): Float32Array | null {
    const place = this.find(commands, new Array<number>(this.outputs.length).fill(0), null);
    if (!place || !this.vertices) return null;
    const amplitudes = new Array<number>(this.modeSums.size).fill(0), at = Float32Array.from(this.mean);
    addUp(this.modeSums, place.cell, this.scaled(place, commands), amplitudes, null);
    amplitudes.forEach((amplitude, m) => {
      const scale = this.units[m] * amplitude, first = m * at.length;
      for (let k = 0; k < at.length; ++k) at[k] += scale * this.modes[first + k];
    });
    return at;
  }

  /** Commands at which outputs come nearest to goals, near those from which it starts (left out: the middles of the
      ranges); where they do not get there, others are tried. Null: it starts outside the map. */
  lead(goals: Goal[], start?: ArrayLike<number>, options: IkOptions = {}): IkResult | null {
    return inverse(this, goals, start, options);
  }
}
