# Plays a camera that films the finger from the side: reads the way of the tip, as `softkin compare -o` writes it
# (other_x_mm, other_z_mm at the time place), and writes what `softkin measure` makes of a film: t_s,x_mm,y_mm.
# Use: awk -v seed=1 -f camera.awk robot.csv >track.csv
# Settings, each by -v NAME=VALUE:
#   fps           frames per second; the tip goes straight between the rows
#   turn_degrees  the camera is turned by so much in the plane of x and z, from x to z
#   right_mm      x of the robot at the camera's origin
#   up_mm         z of the robot there
#   sigma_mm      noise: standard deviation of each coordinate
#   scale         what the camera takes for a mm, where its scale is wrong
#   seed          of the noise: a whole number from 1; the same seed makes the same noise in every awk
BEGIN {
  FS = ","
  pi = 4 * atan2(1, 1)
  fps = set(fps, 30); turn = set(turn_degrees, 4) * pi / 180
  right_mm = set(right_mm, 20); up_mm = set(up_mm, 35)
  sigma_mm = set(sigma_mm, 0.05); scale = set(scale, 1); state = set(seed, 1)
  # squares, as the generator is linear: the noise of seeds side by side would be alike
  for (i = 0; i < 20; ++i) state = (state * state + 1) % 94906249
  ++state   # never 0, which it would keep
  print "t_s,x_mm,y_mm"
}

NR == 1 { for (f = 1; f <= NF; ++f) column[$f] = f; next }
{
  t[++rows] = $column["place"]; x[rows] = $column["other_x_mm"]; z[rows] = $column["other_z_mm"]
}

END {
  at = 1
  for (k = 0; k / fps <= t[rows] + 1e-6; ++k) {
    while (at < rows - 1 && k / fps > t[at + 1]) ++at
    share = (k / fps - t[at]) / (t[at + 1] - t[at])
    see(k / fps, x[at] + share * (x[at + 1] - x[at]) - right_mm, z[at] + share * (z[at + 1] - z[at]) - up_mm)
  }
}

function set(given, otherwise) { return given == "" ? otherwise : given + 0 }

# From the camera's origin to the tip, along the axes of the robot.
function see(time, dx, dz,   radius, angle) {
  radius = sigma_mm * sqrt(-2 * log(uniform()))   # Box and Muller: two normal numbers of two uniform ones
  angle = 2 * pi * uniform()
  printf "%.6f,%.6f,%.6f\n", time, scale * (cos(turn) * dx + sin(turn) * dz) + radius * cos(angle),
         scale * (cos(turn) * dz - sin(turn) * dx) + radius * sin(angle)
}

# Between 0 and 1, by the generator of Park and Miller: rand() differs from awk to awk.
function uniform() {
  state = (16807 * state) % 2147483647
  return state / 2147483647
}
