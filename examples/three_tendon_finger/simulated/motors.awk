# Plays the board and its three drums: reads the G-code of `softkin drive` and writes how long the cables are after
# each move, t_s,tendon1,tendon2,tendon3, as ratios for `softkin fk --path`.
# Use: awk -f motors.awk finger.gcode >cables.csv
BEGIN {
  # those of three_tendon_finger.hardware.yaml
  drum_mm = 6; steps_per_turn = 3200; slack_mm = 2; play_mm = 0.3; rest_mm = 34
  cable_mm_per_step = 2 * 4 * atan2(1, 1) * drum_mm / steps_per_turn
  axes = "XYZ"
  for (i = 1; i <= 3; ++i) at[i] = wound[i] = 0   # home: the motors turned last in the sense that winds
  print "t_s,tendon1,tendon2,tendon3"
}

$1 == "M92" { for (i = 1; i <= 3; ++i) steps_per_mm[i] = word(substr(axes, i, 1)) }
$1 == "M400" && !runs { runs = 1; row() }   # the approach from home is over: the clock of the commands begins
$1 == "G4" { t_s += word("P") / 1000; row() }
$1 == "G1" { move(); if (runs) row() }

# The number behind a letter of this line.
function word(letter,   f) {
  for (f = 2; f <= NF; ++f) if (substr($f, 1, 1) == letter) return substr($f, 2) + 0
}

function move(   i, to, squares, motor) {
  for (i = 1; i <= 3; ++i) {
    to = word(substr(axes, i, 1))
    squares += (to - at[i]) ^ 2
    at[i] = to
    motor = int(to * steps_per_mm[i] + 0.5) * cable_mm_per_step
    # a motor that turns back moves its cable only once it has crossed the play
    if (motor > wound[i]) wound[i] = motor
    if (motor + play_mm < wound[i]) wound[i] = motor + play_mm
  }
  if (runs) t_s += 60 * sqrt(squares) / word("F")   # F is in mm of the axes per minute
}

function row(   i) {
  printf "%.4f", t_s
  for (i = 1; i <= 3; ++i) printf ",%.8f", 1 + (slack_mm - wound[i]) / rest_mm
  print ""
}
