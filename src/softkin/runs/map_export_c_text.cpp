#include <softkin/runs/map_export_text.hpp>

namespace softkin::runs {

const char* const c_evaluation = R"C(
/* Chebyshev polynomials up to a degree, and their slopes, n U_(n-1). */
static inline void map_chebyshev(map_real x, int highest, map_real values[], map_real slopes[]) {
  map_real before = 1, second = 2 * x;
  int n;
  values[0] = 1;
  slopes[0] = 0;
  values[1] = x;
  slopes[1] = 1;
  for (n = 2; n <= highest; ++n) {
    const map_real next = 2 * x * second - before;
    values[n] = 2 * x * values[n - 1] - values[n - 2];
    slopes[n] = (map_real)n * second;
    before = second;
    second = next;
  }
}

/* Sums of a cell at x, from -1 to 1; small terms first, for the rounding. slopes: MAP_INPUTS rows, or 0. */
static inline void map_sums(int cell, const map_real x[], map_real outputs[], map_real *slopes) {
  map_real values[MAP_INPUTS][MAP_DEGREES], rates[MAP_INPUTS][MAP_DEGREES];
  const int last = MAP_INPUTS - 1;
  const map_real *row = map_coefficients + (unsigned long)map_cell_terms[cell + 1] * MAP_OUTPUTS;
  unsigned long r;
  int i, j, k, q;
  for (j = 0; j < MAP_INPUTS; ++j) map_chebyshev(x[j], map_cell_degrees[cell * MAP_INPUTS + j], values[j], rates[j]);
  for (q = 0; q < MAP_OUTPUTS; ++q) outputs[q] = 0;
  for (q = 0; slopes && q < MAP_INPUTS * MAP_OUTPUTS; ++q) slopes[q] = 0;
  for (r = map_cell_runs[cell + 1]; r-- > map_cell_runs[cell];) {
    const unsigned char *run = map_runs + r * MAP_INPUTS; /* degrees of all but the last; number of terms */
    map_real weights[MAP_INPUTS], weight = 1;
    for (j = 0; j < last; ++j) weight *= values[j][run[j]];
    for (i = 0; slopes && i < last; ++i) {
      weights[i] = rates[i][run[i]];
      for (j = 0; j < last; ++j) weights[i] *= j == i ? 1 : values[j][run[j]];
    }
    row -= run[last] * MAP_OUTPUTS;
    for (q = 0; q < MAP_OUTPUTS; ++q) {
      map_real sum = 0, sloped = 0;
      for (k = run[last]; k-- > 0;) {
        sum += values[last][k] * row[k * MAP_OUTPUTS + q];
        sloped += rates[last][k] * row[k * MAP_OUTPUTS + q];
      }
      outputs[q] += weight * sum;
      if (!slopes) continue;
      for (i = 0; i < last; ++i) slopes[i * MAP_OUTPUTS + q] += weights[i] * sum;
      slopes[last * MAP_OUTPUTS + q] += weight * sloped;
    }
  }
}

static inline void map_in_cell(int piece, int cell, const map_real commands[], map_real outputs[], map_real *jacobian) {
  map_real x[MAP_INPUTS], slopes[MAP_INPUTS * MAP_OUTPUTS];
  int j, q;
  for (j = 0; j < MAP_INPUTS; ++j) {
    const map_real *box = map_boxes + (cell * MAP_INPUTS + j) * 3;
    x[j] = (commands[map_variables[piece * MAP_INPUTS + j]] - box[0]) * box[1] + box[2];
  }
  map_sums(cell, x, outputs, jacobian ? slopes : 0);
  for (j = 0; jacobian && j < MAP_INPUTS; ++j) {
    const int input = map_variables[piece * MAP_INPUTS + j];
    const map_real scale = map_boxes[(cell * MAP_INPUTS + j) * 3 + 1];
    for (q = 0; q < MAP_OUTPUTS; ++q) jacobian[q * MAP_INPUTS + input] = scale * slopes[j * MAP_OUTPUTS + q];
  }
}

/* -1: outside the map */
static inline int map_cell_of(int piece, const map_real commands[]) {
  int node = map_roots[piece];
  while (map_node_inputs[node] >= 0)
    node = map_node_children[2 * node + (commands[map_node_inputs[node]] < map_node_at[node] ? 0 : 1)];
  return map_node_children[2 * node];
}
MAP_SLACK
/* Outputs at MAP_INPUTS commands, and jacobian[q * MAP_INPUTS + i], of output q by command i (0: not asked for).
   Returns 0; or MAP_OUTSIDE: the commands are outside the map, and what the outputs hold means nothing. */
static inline int map_fk(const map_real commands[], map_real outputs[], map_real *jacobian) {
  unsigned taut = (1u << MAP_CABLES) - 1;
  int i, change;
  for (i = 0; i < MAP_INPUTS; ++i)
    if (!(commands[i] >= map_low[i] && commands[i] <= map_high[i])) return MAP_OUTSIDE;
  for (change = 0; change <= 4 * MAP_CABLES; ++change) {
    const int piece = map_pieces[taut];
    const int cell = piece < 0 ? -1 : map_cell_of(piece, commands);
    int wrong;
    if (cell < 0) return MAP_OUTSIDE;
    map_in_cell(piece, cell, commands, outputs, jacobian);
    wrong = map_wrong_cable(taut, change >= 2 * MAP_CABLES, commands, outputs);
    if (wrong < 0) return 0;
    taut ^= 1u << wrong;
  }
  return MAP_OUTSIDE;
}
)C";

const char* const c_slack = R"C(
/* All cables are taut at first: one that would push goes slack, one that is longer than it may be is taken up; the one
   that is most wrong first. -1: none is wrong. circles, or no piece: less than the accuracy is not wrong. */
static inline int map_wrong_cable(unsigned taut, int circles, const map_real commands[], const map_real outputs[]) {
  int wrong = -1, pushes = 0, c;
  map_real worst = 0;
  for (c = 0; c < MAP_CABLES; ++c) {
    const short *cable = map_cables + 3 * c; /* input or -1, tension, ratio */
    const int holds = (int)((taut >> c) & 1u);
    const map_real command = cable[0] < 0 ? map_cable_commands[c] : commands[cable[0]];
    const map_real by = (holds ? -outputs[cable[1]] : outputs[cable[2]] - command * (1 + MAP_ROUNDING)) -
                        (circles || map_pieces[taut ^ (1u << c)] < 0 ? map_cable_accuracies[2 * c + !holds] : 0);
    if (!(by > 0) || (pushes && !holds) || (pushes == holds && by <= worst)) continue;
    wrong = c;
    worst = by;
    pushes = holds;
  }
  return wrong;
}
)C";

const char* const c_inverse = R"C(
/* a d = d, a symmetric and positive definite, by L D L^T; what is held stays 0. */
static inline void map_solve(const map_real a[], const int held[], map_real d[]) {
  map_real l[MAP_INPUTS * MAP_INPUTS];
  int i, j, k;
  for (i = 0; i < MAP_INPUTS; ++i)
    for (j = 0; j <= i; ++j) {
      const map_real least = a[i * MAP_INPUTS + i] * MAP_ROUNDING;
      map_real sum = held[i] || held[j] ? (map_real)(i == j) : a[i * MAP_INPUTS + j];
      for (k = 0; k < j; ++k) sum -= l[i * MAP_INPUTS + k] * l[j * MAP_INPUTS + k] * l[k * MAP_INPUTS + k];
      l[i * MAP_INPUTS + j] = i > j ? sum / l[j * MAP_INPUTS + j] : sum > least ? sum : least;
    }
  for (i = 0; i < MAP_INPUTS; ++i)
    for (k = 0; k < i; ++k) d[i] -= l[i * MAP_INPUTS + k] * d[k];
  for (i = 0; i < MAP_INPUTS; ++i) d[i] /= l[i * MAP_INPUTS + i];
  for (i = MAP_INPUTS; i-- > 0;)
    for (k = i + 1; k < MAP_INPUTS; ++k) d[i] -= l[k * MAP_INPUTS + i] * d[k];
}

/* The least s.a.s / 2 - g.s with low <= s <= high, low <= 0 <= high: holds what meets a bound on the way there, frees
   what wants to leave it. */
static inline void map_step(const map_real a[], const map_real g[], const map_real low[], const map_real high[],
                            map_real s[]) {
  map_real left[MAP_INPUTS];
  int held[MAP_INPUTS], turn, i, j; /* -1: at low, 1: at high */
  for (i = 0; i < MAP_INPUTS; ++i) {
    s[i] = 0;
    left[i] = g[i];
    held[i] = 0;
  }
  for (turn = 0; turn < 4 * MAP_INPUTS; ++turn) {
    map_real d[MAP_INPUTS], share = 1, worst = 0;
    int at = -1;
    for (i = 0; i < MAP_INPUTS; ++i) d[i] = held[i] ? 0 : left[i];
    map_solve(a, held, d);
    for (i = 0; i < MAP_INPUTS; ++i) {
      const map_real room = (d[i] > 0 ? high[i] : low[i]) - s[i];
      if (held[i] || (d[i] > 0 ? room >= share * d[i] : room <= share * d[i])) continue;
      share = room / d[i];
      at = i;
    }
    for (i = 0; i < MAP_INPUTS; ++i) {
      s[i] += share * d[i];
      for (j = 0; j < MAP_INPUTS; ++j) left[i] -= share * a[i * MAP_INPUTS + j] * d[j];
    }
    if (at >= 0) {
      held[at] = d[at] > 0 ? 1 : -1;
      s[at] = d[at] > 0 ? high[at] : low[at];
      continue;
    }
    for (i = 0; i < MAP_INPUTS; ++i) {
      const map_real inwards = held[i] > 0 ? -left[i] : left[i];
      if (!held[i] || !(inwards > worst)) continue;
      worst = inwards;
      at = i;
    }
    if (at < 0) return;
    held[at] = 0;
  }
}

/* What is left to the target, by how much that falls per range of each command; its square. Negative: outside. */
static inline map_real map_look(const map_real target[], int marker, const map_real commands[], map_real r[],
                                map_real rows[]) {
  map_real outputs[MAP_OUTPUTS], jacobian[MAP_OUTPUTS * MAP_INPUTS], square = 0;
  int i, k;
  if (map_fk(commands, outputs, jacobian)) return -1;
  for (k = 0; k < 3; ++k) {
    r[k] = target[k] - outputs[3 * marker + k];
    square += r[k] * r[k];
    for (i = 0; i < MAP_INPUTS; ++i)
      rows[k * MAP_INPUTS + i] = jacobian[(3 * marker + k) * MAP_INPUTS + i] * (map_high[i] - map_low[i]);
  }
  return square;
}

/* From the commands to those nearby that lead nearest to the target: Levenberg and Marquardt's method, its steps
   bounded by the ranges. Returns the square of what is left; negative: the commands are outside. */
static inline map_real map_descend(const map_real target[], int marker, map_real commands[]) {
  map_real r[3], rows[3 * MAP_INPUTS], damping = (map_real)1e-3;
  map_real square = map_look(target, marker, commands, r, rows);
  const map_real enough = (map_real)(0.01 * (MAP_REACHED_MM) * (MAP_REACHED_MM));
  int turn, i, j, k;
  for (turn = 0; turn < 100 && square > enough; ++turn) {
    map_real a[MAP_INPUTS * MAP_INPUTS], g[MAP_INPUTS], low[MAP_INPUTS], high[MAP_INPUTS], s[MAP_INPUTS];
    map_real trial[MAP_INPUTS], trial_r[3], trial_rows[3 * MAP_INPUTS], trial_square;
    map_real largest = 0, longest = 0, gain = 0;
    for (i = 0; i < MAP_INPUTS; ++i) {
      const map_real range = map_high[i] - map_low[i];
      low[i] = (map_low[i] - commands[i]) / range;
      high[i] = (map_high[i] - commands[i]) / range;
      g[i] = rows[i] * r[0] + rows[MAP_INPUTS + i] * r[1] + rows[2 * MAP_INPUTS + i] * r[2];
      for (j = 0; j < MAP_INPUTS; ++j)
        for (k = 0, a[i * MAP_INPUTS + j] = 0; k < 3; ++k)
          a[i * MAP_INPUTS + j] += rows[k * MAP_INPUTS + i] * rows[k * MAP_INPUTS + j];
      if (a[i * MAP_INPUTS + i] > largest) largest = a[i * MAP_INPUTS + i];
    }
    if (!(largest > 0)) break;
    for (i = 0; i < MAP_INPUTS; ++i) a[i * MAP_INPUTS + i] += damping * largest;
    map_step(a, g, low, high, s);
    for (i = 0; i < MAP_INPUTS; ++i) {
      const map_real length = s[i] < 0 ? -s[i] : s[i];
      map_real rest = 2 * g[i] + damping * largest * s[i];
      if (length > longest) longest = length;
      for (j = 0; j < MAP_INPUTS; ++j) rest -= a[i * MAP_INPUTS + j] * s[j];
      gain += s[i] * rest; /* of the linear model */
      trial[i] = commands[i] + s[i] * (map_high[i] - map_low[i]);
      trial[i] = trial[i] < map_low[i] ? map_low[i] : trial[i] > map_high[i] ? map_high[i] : trial[i];
    }
    if (!(longest > (map_real)MAP_SHORTEST)) break;
    trial_square = map_look(target, marker, trial, trial_r, trial_rows);
    if (!(trial_square >= 0 && trial_square < square)) {
      damping *= 8;
      continue;
    }
    gain = (square - trial_square) / gain;
    damping *= gain > (map_real)0.75 ? (map_real)0.1 : gain < (map_real)0.25 ? 3 : 1;
    if (damping < (map_real)MAP_SHORTEST) damping = (map_real)MAP_SHORTEST;
    square = trial_square;
    for (i = 0; i < MAP_INPUTS; ++i) commands[i] = trial[i];
    for (k = 0; k < 3; ++k) r[k] = trial_r[k];
    for (i = 0; i < 3 * MAP_INPUTS; ++i) rows[i] = trial_rows[i];
  }
  return square;
}

/* Commands that bring a marker to a target [mm], near those that are given; where they do not get there, others are
   tried. Returns 0: it is within MAP_REACHED_MM; MAP_NOT_REACHED: the commands bring it as near as was found;
   MAP_OUTSIDE: the given commands are outside the map. error_mm: what is left; 0: not asked for. */
static inline int map_ik(const map_real target[3], int marker, map_real commands[], map_real *error_mm) {
  map_real best, square, other[MAP_INPUTS], root;
  int start, i;
  if (marker < 0 || marker >= MAP_MARKERS) return MAP_OUTSIDE;
  best = map_descend(target, marker, commands);
  if (!(best >= 0)) return MAP_OUTSIDE;
  for (start = 1; start < MAP_STARTS && best > (map_real)((MAP_REACHED_MM) * (MAP_REACHED_MM)); ++start) {
    for (i = 0; i < MAP_INPUTS; ++i) {
      const map_real share = (map_real)0.5 + (map_real)(start * (i + 1)) * (map_real)0.618034;
      other[i] = map_low[i] + (share - (map_real)(int)share) * (map_high[i] - map_low[i]);
    }
    square = map_descend(target, marker, other);
    if (!(square >= 0 && square < best)) continue;
    best = square;
    for (i = 0; i < MAP_INPUTS; ++i) commands[i] = other[i];
  }
  root = best > 1 ? best : 1;
  for (i = 0; i < 100 && (root + best / root) / 2 < root; ++i) root = (root + best / root) / 2;
  if (error_mm) *error_mm = best > 0 ? root : 0;
  return best > (map_real)((MAP_REACHED_MM) * (MAP_REACHED_MM)) ? MAP_NOT_REACHED : 0;
}
)C";

const char* const c_estimate = R"C(
/* The normal equations of map_estimate(), a s = g, in spreads, and its sum of squares; negative: outside. */
static inline map_real map_weigh(const map_real readings[], const map_real deviations[], const map_real means[],
                                 const map_real spreads[], const map_real commands[], map_real a[], map_real g[],
                                 map_real *chi_square) {
  map_real outputs[MAP_OUTPUTS], jacobian[MAP_OUTPUTS * MAP_INPUTS], square = 0;
  int i, j, q;
  if (map_fk(commands, outputs, jacobian)) return -1;
  *chi_square = 0;
  for (i = 0; i < MAP_INPUTS; ++i) {
    g[i] = spreads[i] > 0 ? (means[i] - commands[i]) / spreads[i] : 0;
    square += g[i] * g[i];
    for (j = 0; j < MAP_INPUTS; ++j) a[i * MAP_INPUTS + j] = (map_real)(i == j);
  }
  for (q = 0; q < MAP_OUTPUTS; ++q) {
    map_real off;
    if (!(deviations[q] > 0)) continue;
    off = (readings[q] - outputs[q]) / deviations[q];
    *chi_square += off * off;
    for (i = 0; i < MAP_INPUTS; ++i) jacobian[q * MAP_INPUTS + i] *= spreads[i] / deviations[q];
    for (i = 0; i < MAP_INPUTS; ++i) {
      g[i] += off * jacobian[q * MAP_INPUTS + i];
      for (j = 0; j < MAP_INPUTS; ++j)
        a[i * MAP_INPUTS + j] += jacobian[q * MAP_INPUTS + i] * jacobian[q * MAP_INPUTS + j];
    }
  }
  return square + *chi_square;
}

/* Commands that were not measured, such as forces, from outputs that were read: the least of the sum of
   ((output - reading) / deviation)^2 and ((command - mean) / spread)^2, by Gauss' and Newton's method.
   readings, deviations: MAP_OUTPUTS each; a deviation of 0: not read
   means, spreads: MAP_INPUTS each, of what is known before; a spread of 0: the command is known
   commands: where the search begins, and what it found
   covariance: MAP_INPUTS rows of what is left, 0 by known commands; chi_square: of the readings; 0: not asked for
   Returns 0; MAP_NOT_REACHED: not found in 100 steps; MAP_OUTSIDE: the given commands are outside the map. */
static inline int map_estimate(const map_real readings[], const map_real deviations[], const map_real means[],
                               const map_real spreads[], map_real commands[], map_real *covariance,
                               map_real *chi_square) {
  map_real a[MAP_INPUTS * MAP_INPUTS], g[MAP_INPUTS], chi, hold = 0;
  map_real square = map_weigh(readings, deviations, means, spreads, commands, a, g, &chi);
  int turn, i, j, found = 0;
  if (!(square >= 0)) return MAP_OUTSIDE;
  for (turn = 0; turn < 100 && !found; ++turn) {
    map_real held[MAP_INPUTS * MAP_INPUTS], trial_a[MAP_INPUTS * MAP_INPUTS], trial_g[MAP_INPUTS], trial_chi;
    map_real low[MAP_INPUTS], high[MAP_INPUTS], s[MAP_INPUTS], trial[MAP_INPUTS], trial_square, length = 0;
    for (i = 0; i < MAP_INPUTS; ++i) {
      const map_real spread = spreads[i] > 0 ? spreads[i] : 1;
      low[i] = (map_low[i] - commands[i]) / spread;
      high[i] = (map_high[i] - commands[i]) / spread;
      for (j = 0; j < MAP_INPUTS; ++j) held[i * MAP_INPUTS + j] = a[i * MAP_INPUTS + j] + (i == j ? hold : 0);
    }
    map_step(held, g, low, high, s);
    for (i = 0; i < MAP_INPUTS; ++i) {
      trial[i] = commands[i] + s[i] * spreads[i];
      trial[i] = trial[i] < map_low[i] ? map_low[i] : trial[i] > map_high[i] ? map_high[i] : trial[i];
      for (j = 0; j < MAP_INPUTS; ++j) length += s[i] * a[i * MAP_INPUTS + j] * s[j];
    }
    found = length <= MAP_ARRIVED; /* held: at a kink, or an end of the map */
    if (found) break;
    trial_square = map_weigh(readings, deviations, means, spreads, trial, trial_a, trial_g, &trial_chi);
    if (!(trial_square >= 0 && trial_square < square)) {
      hold = hold > 0 ? 8 * hold : 1;
      continue;
    }
    hold = hold > 1 ? hold / 16 : 0;
    square = trial_square;
    chi = trial_chi;
    for (i = 0; i < MAP_INPUTS; ++i) {
      commands[i] = trial[i];
      g[i] = trial_g[i];
    }
    for (i = 0; i < MAP_INPUTS * MAP_INPUTS; ++i) a[i] = trial_a[i];
  }
  for (i = 0; covariance && i < MAP_INPUTS; ++i) {
    map_real column[MAP_INPUTS];
    int held[MAP_INPUTS];
    for (j = 0; j < MAP_INPUTS; ++j) {
      column[j] = (map_real)(i == j);
      held[j] = 0;
    }
    map_solve(a, held, column);
    for (j = 0; j < MAP_INPUTS; ++j) covariance[j * MAP_INPUTS + i] = spreads[i] * spreads[j] * column[j];
  }
  if (chi_square) *chi_square = chi;
  return found ? 0 : MAP_NOT_REACHED;
}
)C";

const char* const c_check = R"C(
/* 0: at MAP_CHECKS commands outputs and slopes are those of softkin, to map_check_tolerances, and commands out of range
   are refused. Else 1 + the number of the first where something is wrong. */
static inline int map_check(void) {
  map_real commands[MAP_INPUTS], outputs[MAP_OUTPUTS], jacobian[MAP_OUTPUTS * MAP_INPUTS];
  int n, i, q;
  for (n = 0; n < MAP_CHECKS; ++n) {
    if (map_fk(map_check_commands + n * MAP_INPUTS, outputs, jacobian)) return n + 1;
    for (q = 0; q < MAP_OUTPUTS; ++q) {
      const map_real off = outputs[q] - map_check_outputs[n * MAP_OUTPUTS + q];
      map_real sloped = -map_check_slopes[n * MAP_OUTPUTS + q]; /* with input i moving i + 1 times its range */
      for (i = 0; i < MAP_INPUTS; ++i)
        sloped += jacobian[q * MAP_INPUTS + i] * (map_real)(i + 1) * (map_high[i] - map_low[i]);
      if (!(off <= map_check_tolerances[q] && -off <= map_check_tolerances[q])) return n + 1;
      if (!(sloped <= map_check_tolerances[MAP_OUTPUTS + q] && -sloped <= map_check_tolerances[MAP_OUTPUTS + q]))
        return n + 1;
    }
  }
  for (i = 0; i < MAP_INPUTS; ++i) {
    for (q = 0; q < MAP_INPUTS; ++q) commands[q] = map_check_commands[q];
    commands[i] = 2 * map_high[i] - map_low[i];
    if (map_fk(commands, outputs, 0) != MAP_OUTSIDE) return MAP_CHECKS + 1;
  }
  return 0;
}
)C";

}  // namespace softkin::runs
