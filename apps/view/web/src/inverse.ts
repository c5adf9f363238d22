/** The part of a map that inverse kinematics uses. */
export interface Differentiable {
  readonly inputs: {low: number; high: number}[];
  fk(commands: ArrayLike<number>): {outputs: number[]; jacobian: number[][]} | null;
}
/** reachedMm: the distance at which a target is reached (0.001 mm); starts: the number of initial guesses (4). */
export interface IkOptions { reachedMm?: number; starts?: number }
export interface IkResult { reached: boolean; commands: number[]; errorMm: number }
/** One of the outputs and its desired value. */
export interface Goal { output: number; value: number }
interface Evaluation { commands: number[]; r: number[]; rows: number[][]; square: number }

/** Solves a d = right for symmetric positive definite a by L D L^T; unknowns with a nonzero entry in fixed stay 0. */
function solve(a: number[][], fixed: number[], right: number[]): number[] {
  const n = right.length, l = a.map((row) => row.slice()), d = right.map((value, i) => fixed[i] ? 0 : value);
  for (let i = 0; i < n; ++i)
    for (let j = 0; j <= i; ++j) {
      let sum = fixed[i] || fixed[j] ? (i === j ? 1 : 0) : a[i][j];
      for (let k = 0; k < j; ++k) sum -= l[i][k] * l[j][k] * l[k][k];
      l[i][j] = i > j ? sum / l[j][j] : Math.max(sum, 1e-12 * a[i][i]);
    }
  for (let i = 0; i < n; ++i) for (let k = 0; k < i; ++k) d[i] -= l[i][k] * d[k];
  for (let i = 0; i < n; ++i) d[i] /= l[i][i];
  for (let i = n; i-- > 0;) for (let k = i + 1; k < n; ++k) d[i] -= l[k][i] * d[k];
  return d;
}

/** Minimises s.a.s / 2 - g.s subject to low <= s <= high, where low <= 0 <= high, by an active-set method: fixes
    variables that meet a bound, and frees those whose multiplier has the wrong sign. */
function boundedStep(a: number[][], g: number[], low: number[], high: number[]): number[] {
  const n = g.length, s = new Array<number>(n).fill(0), residual = g.slice(), fixed = new Array<number>(n).fill(0);
  for (let iteration = 0; iteration < 4 * n; ++iteration) {
    const d = solve(a, fixed, residual);
    let fraction = 1, index = -1, worst = 0;
    for (let i = 0; i < n; ++i) {
      const room = (d[i] > 0 ? high[i] : low[i]) - s[i];
      if (fixed[i] || (d[i] > 0 ? room >= fraction * d[i] : room <= fraction * d[i])) continue;
      [fraction, index] = [room / d[i], i];
    }
    for (let i = 0; i < n; ++i) {
      s[i] += fraction * d[i];
      for (let j = 0; j < n; ++j) residual[i] -= fraction * a[i][j] * d[j];
    }
    if (index >= 0) {
      fixed[index] = Math.sign(d[index]);
      s[index] = d[index] > 0 ? high[index] : low[index];
      continue;
    }
    for (let i = 0; i < n; ++i) {
      const excess = -fixed[i] * residual[i];
      if (fixed[i] && excess > worst) [worst, index] = [excess, i];
    }
    if (index < 0) return s;
    fixed[index] = 0;
  }
  return s;
}

/** Returns the residuals of the goals and their derivatives per range of each command. */
function evaluate(map: Differentiable, goals: Goal[], commands: number[]): Evaluation | null {
  const found = map.fk(commands);
  if (!found) return null;
  const r = goals.map(({output, value}) => value - found.outputs[output]);
  const rows = goals.map(({output}) => map.inputs.map(({low, high}, i) => found.jacobian[output][i] * (high - low)));
  return {commands, r, rows, square: r.reduce((sum, value) => sum + value * value, 0)};
}

/** Minimises the residuals of the goals from an initial guess: the Levenberg-Marquardt method with steps bounded by the
    ranges of the commands. */
function descend(map: Differentiable, goals: Goal[], start: number[], reachedMm: number) {
  const {inputs} = map;
  let current = evaluate(map, goals, start), damping = 1e-3;
  for (let iteration = 0; current && iteration < 100 && current.square > 0.01 * reachedMm * reachedMm; ++iteration) {
    const {rows, r, commands} = current;
    const a = inputs.map((_, i) => inputs.map((_, j) => rows.reduce((sum, row) => sum + row[i] * row[j], 0)));
    const g = inputs.map((_, i) => rows.reduce((sum, row, k) => sum + row[i] * r[k], 0));
    const largest = Math.max(...a.map((row, i) => row[i]));
    if (!(largest > 0)) break;
    a.forEach((row, i) => { row[i] += damping * largest; });
    const room = (which: 'low' | 'high') =>
      inputs.map((input, i) => (input[which] - commands[i]) / (input.high - input.low));
    const s = boundedStep(a, g, room('low'), room('high'));
    if (!(Math.max(...s.map(Math.abs)) > 1e-7)) break;
    const next = evaluate(map, goals, inputs.map(({low, high}, i) =>
      Math.min(Math.max(commands[i] + s[i] * (high - low), low), high)));
    if (!next || !(next.square < current.square)) {
      damping *= 8;
      continue;
    }
    const expected = s.reduce((sum, value, i) =>
      sum + value * (2 * g[i] + damping * largest * value - a[i].reduce((of, v, j) => of + v * s[j], 0)), 0);
    const gain = (current.square - next.square) / expected;
    damping = Math.max(damping * (gain > 0.75 ? 0.1 : gain < 0.25 ? 3 : 1), 1e-7);
    current = next;
  }
  return current;
}

/** Finds commands that bring outputs nearest to their goals, from several initial guesses if necessary. start: the
    first guess, by default the middles of the ranges. Returns null where the map has no value at the start. */
export function inverse(map: Differentiable, goals: Goal[], start: ArrayLike<number> | undefined,
                        {reachedMm = 1e-3, starts = 4}: IkOptions): IkResult | null {
  const middle = map.inputs.map(({low, high}) => low + (high - low) / 2);
  let best = descend(map, goals, Array.from(start ?? middle), reachedMm);
  if (!best && start) return null;
  for (let n = 1; n < starts && !(best && best.square <= reachedMm * reachedMm); ++n) {
    const other = descend(map, goals, map.inputs.map(({low, high}, i) => {
      const fraction = 0.5 + n * (i + 1) * 0.618034;
      return low + (fraction - Math.floor(fraction)) * (high - low);
    }), reachedMm);
    if (other && !(best && best.square <= other.square)) best = other;
  }
  if (!best) return null;
  return {reached: best.square <= reachedMm * reachedMm, commands: best.commands, errorMm: Math.sqrt(best.square)};
}
