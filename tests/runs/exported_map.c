/* Of one exported map, whose name stands for map_ and MAP_: for each row of commands in a file, all as double, the code
   of fk, outputs, Jacobian; what ik gives from 45 % of the ranges for those outputs, and for a target four times as far;
   what it gives from the commands themselves for a target 0.1 mm beside; what estimate tells of all commands but the
   first from these outputs, a little off. After them check() and MAP_TABLE_BYTES. */
static void map_run_ik(const map_real target[3], map_real commands[], FILE *out) {
  map_real error = -1;
  int i;
  put(map_ik(target, 0, commands, &error), out);
  put((double)error, out);
  for (i = 0; i < MAP_INPUTS; ++i) put((double)commands[i], out);
}

static void map_run_estimate(const map_real outputs[], const map_real commands[], FILE *out) {
  map_real readings[MAP_OUTPUTS], deviations[MAP_OUTPUTS], means[MAP_INPUTS], spreads[MAP_INPUTS], told[MAP_INPUTS];
  map_real covariance[MAP_INPUTS * MAP_INPUTS], chi_square = -1;
  int i;
  for (i = 0; i < MAP_OUTPUTS; ++i) {
    readings[i] = outputs[i] + (map_real)(0.01 * (i % 3 - 1));
    deviations[i] = (map_real)(i % 4 == 3 ? 0 : 0.1);
  }
  for (i = 0; i < MAP_INPUTS; ++i) {
    means[i] = (map_low[i] + map_high[i]) / 2;
    spreads[i] = (map_real)(i > 0 ? 1 : 0) * (map_high[i] - map_low[i]) / 2;
    told[i] = i > 0 ? means[i] : commands[i];
  }
  put(map_estimate(readings, deviations, means, spreads, told, covariance, &chi_square), out);
  put((double)chi_square, out);
  for (i = 0; i < MAP_INPUTS; ++i) put((double)told[i], out);
  for (i = 0; i < MAP_INPUTS * MAP_INPUTS; ++i) put((double)covariance[i], out);
}

static void map_run(FILE *in, FILE *out) {
  double row[MAP_INPUTS];
  while (fread(row, sizeof row, 1, in) == 1) {
    map_real commands[MAP_INPUTS], start[MAP_INPUTS], outputs[MAP_OUTPUTS], alone[MAP_OUTPUTS], target[3];
    map_real jacobian[MAP_OUTPUTS * MAP_INPUTS];
    int i, k, code;
    for (i = 0; i < MAP_INPUTS; ++i) commands[i] = (map_real)row[i];
    code = map_fk(commands, outputs, jacobian);
    put(code, out);
    put(map_fk(commands, alone, 0), out);
    if (code) continue;
    for (i = 0; i < MAP_OUTPUTS; ++i) put((double)outputs[i], out);
    for (i = 0; i < MAP_OUTPUTS; ++i) put((double)alone[i], out);
    for (i = 0; i < MAP_OUTPUTS * MAP_INPUTS; ++i) put((double)jacobian[i], out);
    for (k = 1; k <= 4; k *= 4) {
      for (i = 0; i < MAP_INPUTS; ++i) start[i] = map_low[i] + (map_real)0.45 * (map_high[i] - map_low[i]);
      for (i = 0; i < 3; ++i) target[i] = (map_real)k * outputs[i];
      map_run_ik(target, start, out);
    }
    for (i = 0; i < 3; ++i) target[i] = outputs[i] + (map_real)(i ? 0 : 0.1);
    for (i = 0; i < MAP_INPUTS; ++i) start[i] = commands[i];
    map_run_ik(target, start, out);
    map_run_estimate(outputs, commands, out);
  }
  put(map_check(), out);
  put((double)MAP_TABLE_BYTES, out);
}
