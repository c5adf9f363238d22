#include <softkin/runs/map_export_text.hpp>

namespace softkin::runs {

const char* const js_evaluation = R"JS(
function bytesOf(text) {
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Little-endian numbers. */
function numbersOf(text, Type, read) {
  const bytes = bytesOf(text), view = new DataView(bytes.buffer);
  return Type.from({length: bytes.length / Type.BYTES_PER_ELEMENT}, (_, i) => view[read](i * Type.BYTES_PER_ELEMENT, true));
}

for (const sums of [tables.outputs, tables.modes]) sums.coefficients = numbersOf(sums.coefficients, Float64Array, 'getFloat64');

/** Chebyshev polynomials up to a degree, and their slopes, n U_(n-1). */
function chebyshev(x, highest) {
  const values = [1, x], slopes = [0, 1];
  for (let n = 2, before = 1, second = 2 * x; n <= highest; ++n) {
    values.push(2 * x * values[n - 1] - values[n - 2]);
    slopes.push(n * second);
    [before, second] = [second, 2 * x * second - before];
  }
  return {values, slopes};
}

/** Sums of a cell at x, from -1 to 1; slopes: by each x, or null. */
function addUp(sums, cell, x, values, slopes) {
  const n = x.length, last = n - 1, size = sums.size, {runs, coefficients} = sums;
  const of = x.map((value, j) => chebyshev(value, sums.highest[cell * n + j]));
  const weights = new Array(last);
  let row = sums.terms[cell + 1] * size;
  values.fill(0);
  if (slopes) for (const slope of slopes) slope.fill(0);
  for (let r = sums.cells[cell + 1]; r-- > sums.cells[cell];) {
    const run = r * n, count = runs[run + last]; // degrees of all but the last; number of terms
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

/** The numbers from -1 to 1 over the box of a cell. */
function scaled(place, commands) {
  return tables.variables[place.piece].map((input, j) => {
    const [low, high] = tables.boxes[place.cell][j];
    return high > low ? (2 * commands[input] - low - high) / (high - low) : 0;
  });
}

function cellOf(piece, commands) {
  let node = tables.nodes[tables.roots[piece]];
  while (node.length > 1) node = tables.nodes[commands[node[0]] < node[1] ? node[2] : node[3]];
  return node[0];
}

/** All cables are taut at first: one that would push goes slack, one that is longer than it may be is taken up; the one
    that is most wrong first. circles, or no piece: less than the accuracy is not wrong. */
function wrongCable(taut, circles, commands, values) {
  let wrong = -1, pushes = false, worst = 0;
  tables.cables.forEach(({input, command, tension, ratio}, c) => {
    const holds = ((taut >> c) & 1) === 1;
    const excess = holds ? -values[tension] : values[ratio] - (input < 0 ? command : commands[input]) * (1 + 1e-12);
    const lenient = circles || tables.pieces[taut ^ (1 << c)] < 0;
    const by = excess - (lenient ? outputs[holds ? tension : ratio].accuracy : 0);
    if (!(by > 0) || (pushes && !holds) || (pushes === holds && by <= worst)) return;
    [wrong, worst, pushes] = [c, by, holds];
  });
  return wrong;
}

function find(commands, values, slopes) {
  if (commands.length !== inputs.length || !inputs.every((_, i) => typeof commands[i] === 'number'))
    throw new TypeError(`the map takes ${inputs.length} numbers`);
  if (!inputs.every(({low, high}, i) => commands[i] >= low && commands[i] <= high)) return null;
  let taut = (1 << tables.cables.length) - 1;
  for (let change = 0; change <= 4 * tables.cables.length; ++change) {
    const place = {piece: tables.pieces[taut], cell: -1};
    if (place.piece >= 0) place.cell = cellOf(place.piece, commands);
    if (place.cell < 0) return null;
    addUp(tables.outputs, place.cell, scaled(place, commands), values, slopes);
    const wrong = wrongCable(taut, change >= 2 * tables.cables.length, commands, values);
    if (wrong < 0) return place;
    taut ^= 1 << wrong;
  }
  return null;
}

/**
 * @param {ArrayLike<number>} commands one per input
 * @returns {{outputs: number[], jacobian: number[][]} | null} outputs, and by how much each changes per command:
 *   jacobian[output][input]; null: the commands are outside the map
 */
export function fk(commands) {
  const values = new Array(outputs.length).fill(0), slopes = inputs.map(() => new Array(outputs.length).fill(0));
  const place = find(commands, values, slopes);
  if (!place) return null;
  const jacobian = outputs.map(() => new Array(inputs.length).fill(0));
  tables.variables[place.piece].forEach((input, j) => {
    const [low, high] = tables.boxes[place.cell][j];
    if (high > low) for (let q = 0; q < outputs.length; ++q) jacobian[q][input] = 2 / (high - low) * slopes[j][q];
  });
  return {outputs: values, jacobian};
}
)JS";

const char* const js_shape = R"JS(
const mean = numbersOf(shapeTables.mean, Float32Array, 'getFloat32');
const modes = numbersOf(shapeTables.modes, Int16Array, 'getInt16'); // one after the other

/** Of the robot's mesh. */
export const vertices = mean.length / 3;

/**
 * @param {ArrayLike<number>} commands one per input
 * @returns {Float32Array | null} x, y, z of each vertex [mm]; null: the commands are outside the map
 */
export function shape(commands) {
  const place = find(commands, new Array(outputs.length).fill(0), null);
  if (!place) return null;
  const amplitudes = new Array(tables.modes.size).fill(0), at = Float32Array.from(mean);
  addUp(tables.modes, place.cell, scaled(place, commands), amplitudes, null);
  amplitudes.forEach((amplitude, m) => {
    const scale = shapeTables.units[m] * amplitude, first = m * at.length;
    for (let k = 0; k < at.length; ++k) at[k] += scale * modes[first + k];
  });
  return at;
}
)JS";

const char* const js_inverse = R"JS(
/** a d = right, a symmetric and positive definite, by L D L^T; what is held stays 0. */
function solve(a, held, right) {
  const n = right.length, l = a.map((row) => row.slice()), d = right.map((value, i) => held[i] ? 0 : value);
  for (let i = 0; i < n; ++i)
    for (let j = 0; j <= i; ++j) {
      let sum = held[i] || held[j] ? (i === j ? 1 : 0) : a[i][j];
      for (let k = 0; k < j; ++k) sum -= l[i][k] * l[j][k] * l[k][k];
      l[i][j] = i > j ? sum / l[j][j] : Math.max(sum, 1e-12 * a[i][i]);
    }
  for (let i = 0; i < n; ++i) for (let k = 0; k < i; ++k) d[i] -= l[i][k] * d[k];
  for (let i = 0; i < n; ++i) d[i] /= l[i][i];
  for (let i = n; i-- > 0;) for (let k = i + 1; k < n; ++k) d[i] -= l[k][i] * d[k];
  return d;
}

/** The least s.a.s / 2 - g.s with low <= s <= high, low <= 0 <= high: holds what meets a bound on the way there, frees
    what wants to leave it. */
function boundedStep(a, g, low, high) {
  const n = g.length, s = new Array(n).fill(0), left = g.slice(), held = new Array(n).fill(0);
  for (let turn = 0; turn < 4 * n; ++turn) {
    const d = solve(a, held, left);
    let share = 1, at = -1, worst = 0;
    for (let i = 0; i < n; ++i) {
      const room = (d[i] > 0 ? high[i] : low[i]) - s[i];
      if (held[i] || (d[i] > 0 ? room >= share * d[i] : room <= share * d[i])) continue;
      [share, at] = [room / d[i], i];
    }
    for (let i = 0; i < n; ++i) {
      s[i] += share * d[i];
      for (let j = 0; j < n; ++j) left[i] -= share * a[i][j] * d[j];
    }
    if (at >= 0) {
      held[at] = Math.sign(d[at]);
      s[at] = d[at] > 0 ? high[at] : low[at];
      continue;
    }
    for (let i = 0; i < n; ++i) if (held[i] && -held[i] * left[i] > worst) [worst, at] = [-held[i] * left[i], i];
    if (at < 0) return s;
    held[at] = 0;
  }
  return s;
}

/** What is left to the target, and by how much that falls per range of each command. */
function look(target, marker, commands) {
  const found = fk(commands);
  if (!found) return null;
  const r = target.map((value, k) => value - found.outputs[3 * marker + k]);
  const rows = r.map((_, k) => inputs.map(({low, high}, i) => found.jacobian[3 * marker + k][i] * (high - low)));
  return {commands, r, rows, square: r.reduce((sum, value) => sum + value * value, 0)};
}

/** From the commands to those nearby that lead nearest to the target: Levenberg and Marquardt's method, its steps
    bounded by the ranges. */
function descend(target, marker, start, reachedMm) {
  let here = look(target, marker, start), damping = 1e-3;
  for (let turn = 0; here && turn < 100 && here.square > 0.01 * reachedMm * reachedMm; ++turn) {
    const {rows, r, commands} = here;
    const a = inputs.map((_, i) => inputs.map((_, j) => rows.reduce((sum, row) => sum + row[i] * row[j], 0)));
    const g = inputs.map((_, i) => rows.reduce((sum, row, k) => sum + row[i] * r[k], 0));
    const most = Math.max(...a.map((row, i) => row[i]));
    if (!(most > 0)) break;
    a.forEach((row, i) => { row[i] += damping * most; });
    const room = (which) => inputs.map((input, i) => (input[which] - commands[i]) / (input.high - input.low));
    const s = boundedStep(a, g, room('low'), room('high'));
    if (!(Math.max(...s.map(Math.abs)) > 1e-7)) break;
    const there = look(target, marker, inputs.map(({low, high}, i) =>
      Math.min(Math.max(commands[i] + s[i] * (high - low), low), high)));
    if (!there || !(there.square < here.square)) {
      damping *= 8;
      continue;
    }
    const expected = s.reduce((sum, value, i) =>
      sum + value * (2 * g[i] + damping * most * value - a[i].reduce((of, v, j) => of + v * s[j], 0)), 0);
    const gain = (here.square - there.square) / expected;
    damping = Math.max(damping * (gain > 0.75 ? 0.1 : gain < 0.25 ? 3 : 1), 1e-7);
    here = there;
  }
  return here;
}

/**
 * Commands that bring a marker to a target, near those from which it starts; where they do not get there, others are
 * tried.
 *
 * @param {number | string} marker its number in markers, or its name
 * @param {ArrayLike<number>} target x, y, z [mm]
 * @param {ArrayLike<number>} [start] commands; left out: the middles of the ranges
 * @param {{reachedMm?: number, starts?: number}} [options] as near it is there (0.001 mm); from so many starts it tries (4)
 * @returns {{reached: boolean, commands: number[], errorMm: number} | null} null: it starts outside the map
 */
export function ik(marker, target, start, options = {}) {
  const number = typeof marker === 'string' ? markers.indexOf(marker) : marker;
  if (!(number in markers)) throw new RangeError(`the map has no marker ${marker}`);
  const {reachedMm = 1e-3, starts = 4} = options, point = Array.from(target);
  const middle = inputs.map(({low, high}) => low + (high - low) / 2);
  let best = descend(point, number, Array.from(start ?? middle), reachedMm);
  if (!best && start) return null;
  for (let n = 1; n < starts && !(best?.square <= reachedMm * reachedMm); ++n) {
    const other = descend(point, number, inputs.map(({low, high}, i) => {
      const share = 0.5 + n * (i + 1) * 0.618034;
      return low + (share - Math.floor(share)) * (high - low);
    }), reachedMm);
    if (other && !(best?.square <= other.square)) best = other;
  }
  return best && {reached: best.square <= reachedMm * reachedMm, commands: best.commands, errorMm: Math.sqrt(best.square)};
}
)JS";

const char* const js_check = R"JS(
/**
 * Compares with answers of softkin.
 *
 * @returns {string} '' where all are the same; else what is not
 */
export function check() {
  const off = (found, wanted, scale) => !(Math.abs(found - wanted) <= scale);
  for (const [n, commands] of answers.commands.entries()) {
    const found = fk(commands);
    if (!found) return `the map has no answer at [${commands}]`;
    for (const [q, {name}] of outputs.entries()) {
      // input i moves i + 1 times its range
      const slope = inputs.reduce((sum, {low, high}, i) => sum + found.jacobian[q][i] * (i + 1) * (high - low), 0);
      if (off(found.outputs[q], answers.outputs[n][q], 1e-12 * answers.outputScale[q]))
        return `${name} at [${commands}] is ${found.outputs[q]}, not ${answers.outputs[n][q]}`;
      if (off(slope, answers.slopes[n][q], 1e-10 * answers.slopeScale[q])) return `slopes of ${name} at [${commands}]`;
    }
  }
  const outside = answers.commands[0].map((command, i) => i === 0 ? 2 * inputs[0].high - inputs[0].low : command);
  return fk(outside) ? 'commands out of range are not refused' : '';
}
)JS";

const char* const js_types = R"TS(
/** Outputs, and by how much each changes per command: jacobian[output][input]. Null: the commands are outside the map. */
export function fk(commands: ArrayLike<number>): {outputs: number[]; jacobian: number[][]} | null;

/** Commands that bring a marker to a target [mm], near those from which it starts (left out: the middles of the ranges);
    where they do not get there, others are tried. Null: it starts outside the map. */
export function ik(marker: number | string, target: ArrayLike<number>, start?: ArrayLike<number>,
                   options?: {reachedMm?: number; starts?: number}):
    {reached: boolean; commands: number[]; errorMm: number} | null;

/** Compares with answers of softkin: '' where all are the same, else what is not. */
export function check(): string;
)TS";

}  // namespace softkin::runs
