/** What inverse kinematics asks of a map. */
export interface Differentiable {
  readonly inputs: {low: number; high: number}[];
  fk(commands: ArrayLike<number>): {outputs: number[]; jacobian: number[][]} | null;
}
/** reachedMm: as near it is there (0.001 mm); starts: from so many it tries (4). */
export interface IkOptions { reachedMm?: number; starts?: number }
export interface IkResult { reached: boolean; commands: number[]; errorMm: number }
/** One number of the outputs, and what it should be. */
export interface Goal { output: number; value: number }
interface Look { commands: number[]; r: number[]; rows: number[][]; square: number }

/** a d = right, a symmetric and positive definite, by L D L^T; what is held stays 0. */
function solve(a: number[][], held: number[], right: number[]): number[] {
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
function boundedStep(a: number[][], g: number[], low: number[], high: number[]): number[] {
  const n = g.length, s = new Array<number>(n).fill(0), left = g.slice(), held = new Array<number>(n).fill(0);
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

/** What is left to the goals, and by how much that falls per range of each command. */
function look(map: Differentiable, goals: Goal[], commands: number[]): Look | null {
  const found = map.fk(commands);
  if (!found) return null;
  const r = goals.map(({output, value}) => value - found.outputs[output]);
  const rows = goals.map(({output}) => map.inputs.map(({low, high}, i) => found.jacobian[output][i] * (high - low)));
  return {commands, r, rows, square: r.reduce((sum, value) => sum + value * value, 0)};
}

/** From the commands to those nearby that lead nearest to the goals: Levenberg and Marquardt's method, its steps
    bounded by the ranges. */
function descend(map: Differentiable, goals: Goal[], start: number[], reachedMm: number) {
  const {inputs} = map;
  let here = look(map, goals, start), damping = 1e-3;
  for (let turn = 0; here && turn < 100 && here.square > 0.01 * reachedMm * reachedMm; ++turn) {
    const {rows, r, commands} = here;
    const a = inputs.map((_, i) => inputs.map((_, j) => rows.reduce((sum, row) => sum + row[i] * row[j], 0)));
    const g = inputs.map((_, i) => rows.reduce((sum, row, k) => sum + row[i] * r[k], 0));
    const most = Math.max(...a.map((row, i) => row[i]));
    if (!(most > 0)) break;
    a.forEach((row, i) => { row[i] += damping * most; });
    const room = (which: 'low' | 'high') =>
      inputs.map((input, i) => (input[which] - commands[i]) / (input.high - input.low));
    const s = boundedStep(a, g, room('low'), room('high'));
    if (!(Math.max(...s.map(Math.abs)) > 1e-7)) break;
    const there = look(map, goals, inputs.map(({low, high}, i) =>
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

export function inverse(map: Differentiable, goals: Goal[], start: ArrayLike<number> | undefined,
                        {reachedMm = 1e-3, starts = 4}: IkOptions): IkResult | null {
  const middle = map.inputs.map(({low, high}) => low + (high - low) / 2);
  let best = descend(map, goals, Array.from(start ?? middle), reachedMm);
  if (!best && start) return null;
  for (let n = 1; n < starts && !(best && best.square <= reachedMm * reachedMm); ++n) {
    const other = descend(map, goals, map.inputs.map(({low, high}, i) => {
      const share = 0.5 + n * (i + 1) * 0.618034;
      return low + (share - Math.floor(share)) * (high - low);
    }), reachedMm);
    if (other && !(best && best.square <= other.square)) best = other;
  }
  if (!best) return null;
  return {reached: best.square <= reachedMm * reachedMm, commands: best.commands, errorMm: Math.sqrt(best.square)};
}
