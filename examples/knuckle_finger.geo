// Finger with three V notches ("knuckles"), 120 x 25 x 25 mm, x along it, base at x = 0, hinges at z = 0.
// Shared by cable_gripper, cable_gripper_two_materials and three_tendon_finger, whose .geo name the regions:
// segment[0..3] and knuckle[0..2] are the volumes from base to tip, base[] and tip[] the end faces, eyelet[0..5] the
// patches where a cable leaves and enters the body, from base to tip.
SetFactory("OpenCASCADE");

length = 120;  width = 25;  height = 25;
notch_x[] = {30, 64, 98};
hinge = 5;        // thickness left under a notch
flat = 4;         // half the width of a notch's bottom
slope = 0.4;      // of a notch's walls, dx/dz
knuckle_half = 7; // a knuckle reaches this far to either side of its notch's middle
wall_z = hinge + (knuckle_half - flat) / slope;  // where a knuckle's side meets the notch's wall
top_half = flat + (height - hinge) * slope;      // half the width of a notch at the top
eyelet_z = 18;    // an eyelet reaches from here to the top,
eyelet_half = 3.5;  // and this far to either side of y = 0
hinge_size = 3.2;
block_size = 8;

// Prism over the polygon corner_x, corner_z, extruded along y. Sets `solid`.
Macro Slab
  n = #corner_x[];
  p = newp;
  For i In {0 : n - 1}
    Point(p + i) = {corner_x[i], -width / 2, corner_z[i]};
  EndFor
  l = newl;
  For i In {0 : n - 1}
    Line(l + i) = {p + i, p + (i + 1) % n};
  EndFor
  c = newll;  Curve Loop(c) = {l : l + n - 1};
  s = news;   Plane Surface(s) = {c};
  swept[] = Extrude {0, width, 0} { Surface{s}; };
  solid = swept[1];
Return

parts[] = {};
For k In {0 : 3}
  // A segment runs from the knuckle behind it (or the base) to the knuckle before it (or the tip).
  corner_x[] = {};  corner_z[] = {};
  If (k == 0)
    corner_x[] += {0, 0};  corner_z[] += {height, 0};
  Else
    corner_x[] += {notch_x[k - 1] + top_half, notch_x[k - 1] + knuckle_half, notch_x[k - 1] + knuckle_half};
    corner_z[] += {height, wall_z, 0};
  EndIf
  If (k == 3)
    corner_x[] += {length, length};  corner_z[] += {0, height};
  Else
    corner_x[] += {notch_x[k] - knuckle_half, notch_x[k] - knuckle_half, notch_x[k] - top_half};
    corner_z[] += {0, wall_z, height};
  EndIf
  Call Slab;
  parts[] += solid;
  If (k < 3)
    corner_x[] = {notch_x[k] - knuckle_half, notch_x[k] + knuckle_half, notch_x[k] + knuckle_half,
                  notch_x[k] + flat, notch_x[k] - flat, notch_x[k] - knuckle_half};
    corner_z[] = {0, 0, wall_z, hinge, hinge, wall_z};
    Call Slab;
    parts[] += solid;
  EndIf
EndFor

eyelet_top = top_half - flat;                  // along x, from the notch's bottom edge to the eyelet's upper
eyelet_bottom = (eyelet_z - hinge) * slope;    // and lower edge
patches[] = {};
For k In {0 : 2}
  For side In {-1 : 1 : 2}
    x = notch_x[k] + side * flat;
    p = newp;
    Point(p)     = {x + side * eyelet_bottom, -eyelet_half, eyelet_z};
    Point(p + 1) = {x + side * eyelet_bottom, eyelet_half, eyelet_z};
    Point(p + 2) = {x + side * eyelet_top, eyelet_half, height};
    Point(p + 3) = {x + side * eyelet_top, -eyelet_half, height};
    l = newl;
    For i In {0 : 3}
      Line(l + i) = {p + i, p + (i + 1) % 4};
    EndFor
    c = newll;  Curve Loop(c) = {l : l + 3};
    s = news;   Plane Surface(s) = {c};
    patches[] += {s};
  EndFor
EndFor
BooleanFragments{ Volume{parts[]}; Delete; }{ Surface{patches[]}; Delete; }

e = 1e-3;
cuts[] = {0};
For k In {0 : 2}
  cuts[] += {notch_x[k] - knuckle_half, notch_x[k] + knuckle_half};
EndFor
cuts[] += {length};
segment[] = {};
knuckle[] = {};
For k In {0 : 6}
  found[] = {};
  found[] += Volume In BoundingBox{cuts[k] - e, -width, -e, cuts[k + 1] + e, width, height + e};
  If (k % 2 == 0)
    segment[] += found[];
  Else
    knuckle[] += found[];
  EndIf
EndFor
base[] = Surface In BoundingBox{-e, -width, -e, e, width, height + e};
tip[] = Surface In BoundingBox{length - e, -width, -e, length + e, width, height + e};
eyelet[] = {};
For k In {0 : 2}
  eyelet[] += Surface In BoundingBox{notch_x[k] - flat - eyelet_top - e, -eyelet_half - e, eyelet_z - e,
                                     notch_x[k] - flat - eyelet_bottom + e, eyelet_half + e, height + e};
  eyelet[] += Surface In BoundingBox{notch_x[k] + flat + eyelet_bottom - e, -eyelet_half - e, eyelet_z - e,
                                     notch_x[k] + flat + eyelet_top + e, eyelet_half + e, height + e};
EndFor

Characteristic Length{ PointsOf{ Volume{segment[]}; } } = block_size;
Characteristic Length{ PointsOf{ Volume{knuckle[]}; } } = hinge_size;
Mesh.Optimize = 1;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
