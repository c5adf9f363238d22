#!/bin/sh
# Writes the paths of markers that the examples follow; their READMEs explain the sizes.
set -eu
cd "$(dirname "$0")/../examples"

# Writes FILE. Waypoint k of n is point(k), the coordinates after the time, with RATE waypoints per second.
path() {  # FILE HEADER N RATE, awk function point(k, n) on standard input
  file=$1 header=$2 n=$3 rate=$4
  awk -v n="$n" -v header="$header" -v rate="$rate" "$(cat)"'
    BEGIN {
      print "t_s," header
      for (k = 0; k < n; ++k) printf "%.1f,%s\n", k / rate, point(k, n)
    }' </dev/null >"$file"
}

# 26 mm down in 30 steps, 20 mm to the right in 24
path three_tendon_finger/letter_l.csv x_mm,z_mm 55 10 <<'EOF'
function point(k, n) {
  return k <= 30 ? sprintf("%.4f,%.4f", 72, 80 - 26 * k / 30) : sprintf("%.4f,%.4f", 72 + 20 * (k - 30) / 24, 54)
}
EOF

# a drop of 26 mm with its point upwards, which leans to the right
path three_tendon_finger/flame.csv x_mm,z_mm 85 10 <<'EOF'
function point(k, n,   angle, up) {
  angle = 2 * atan2(0, -1) * k / (n - 1)
  up = (1 + cos(angle)) / 2
  return sprintf("%.4f,%.4f", 72 + 11 * sin(angle) * sqrt(1 - up) ^ 1.5 + 4 * up ^ 2, 66 + 13 * cos(angle))
}
EOF

# a circle around a point near the boundary of the workspace of the tip
path three_tendon_finger/beyond.csv x_mm,z_mm 61 10 <<'EOF'
function point(k, n,   angle) {
  angle = 2 * atan2(0, -1) * k / (n - 1)
  return sprintf("%.4f,%.4f", 72 + 10 * sin(angle), 80 - 10 * cos(angle))
}
EOF

# a circle well inside the workspace, in 12 s
path three_tendon_finger/circle.csv x_mm,z_mm 25 2 <<'EOF'
function point(k, n,   angle) {
  angle = 2 * atan2(0, -1) * k / (n - 1)
  return sprintf("%.4f,%.4f", 76 + 8 * sin(angle), 66 + 8 * cos(angle))
}
EOF

# three lobes around the axis, each rising and sinking
path three_chamber_actuator/curve.csv x_mm,y_mm,z_mm 61 10 <<'EOF'
function point(k, n,   angle, radius) {
  angle = 2 * atan2(0, -1) * k / (n - 1)
  radius = 8 + 2 * cos(3 * angle)
  return sprintf("%.4f,%.4f,%.4f", radius * cos(angle), radius * sin(angle), 138.8 + 0.7 * sin(3 * angle))
}
EOF
