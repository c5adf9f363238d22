// Actuator of three bellows around the z axis, 48 x 48 x 136 mm, base at z = 0, a cap at either end.
// Remesh: gmsh -3 three_chamber_actuator.geo -o three_chamber_actuator.msh
SetFactory("OpenCASCADE");

height = 136;
cap_radius = 24;  cap = 8;
axis_radius = 11.5;   // from the z axis to the axis of a bellows
peak = 12.5;          // circumradius of a bellows' hexagon at its widest
valley = 7.5;         // and at its narrowest
wall = 1.9;           // from outer to inner circumradius; 1.55 mm across the slanted walls
folds = 5;
half_pitch = (height - 2 * cap) / (2 * folds);

// Solid between hexagons of circumradius r1 at z1 and r2 at z2 around (x, y), a corner at `angle`. Sets `solid`.
Macro HexagonFrustum
  p = newp;
  For i In {0 : 5}
    a = angle + i * Pi / 3;
    Point(p + i) = {x + r1 * Cos(a), y + r1 * Sin(a), z1};
    Point(p + 6 + i) = {x + r2 * Cos(a), y + r2 * Sin(a), z2};
  EndFor
  l = newl;
  For i In {0 : 5}
    Line(l + i) = {p + i, p + (i + 1) % 6};
    Line(l + 6 + i) = {p + 6 + i, p + 6 + (i + 1) % 6};
    Line(l + 12 + i) = {p + i, p + 6 + i};
  EndFor
  c = newll;  Curve Loop(c) = {l : l + 5};       f = news;  Plane Surface(f) = {c};  faces[] = {f};
  c = newll;  Curve Loop(c) = {l + 6 : l + 11};  f = news;  Plane Surface(f) = {c};  faces[] += {f};
  For i In {0 : 5}
    c = newll;
    Curve Loop(c) = {l + i, l + 12 + (i + 1) % 6, -(l + 6 + i), -(l + 12 + i)};
    f = news;  Plane Surface(f) = {c};  faces[] += {f};
  EndFor
  s = newsl;  Surface Loop(s) = {faces[]};
  solid = newv;  Volume(solid) = {s};
Return

v = newv;  Cylinder(v) = {0, 0, 0, 0, 0, cap, cap_radius};             outer[] = {v};
v = newv;  Cylinder(v) = {0, 0, height - cap, 0, 0, cap, cap_radius};  outer[] += {v};
air[] = {};
For k In {0 : 2}
  angle = Pi / 2 + k * 2 * Pi / 3;
  x = axis_radius * Cos(angle);
  y = axis_radius * Sin(angle);
  inner[] = {};
  For fold In {0 : 2 * folds - 1}
    z1 = cap + fold * half_pitch;
    z2 = z1 + half_pitch;
    peak1 = fold % 2;  // is the section at z1 a peak
    r1 = peak1 ? peak : valley;
    r2 = peak1 ? valley : peak;
    Call HexagonFrustum;
    outer[] += {solid};
    r1 -= wall;
    r2 -= wall;
    Call HexagonFrustum;
    inner[] += {solid};
  EndFor
  air[] += BooleanUnion{ Volume{inner[0]}; Delete; }{ Volume{inner[{1 : #inner[] - 1}]}; Delete; };
EndFor
hull[] = BooleanUnion{ Volume{outer[0]}; Delete; }{ Volume{outer[{1 : #outer[] - 1}]}; Delete; };
BooleanFragments{ Volume{hull[]}; Delete; }{ Volume{air[]}; Delete; }

e = 1e-3;
body[] = Volume{:};
For k In {0 : 2}
  angle = Pi / 2 + k * 2 * Pi / 3;
  x = axis_radius * Cos(angle);
  y = axis_radius * Sin(angle);
  chamber[] = Volume In BoundingBox{x - peak, y - peak, cap - e, x + peak, y + peak, height - cap + e};
  body[] -= chamber[];
  Physical Volume(Sprintf("chamber%g", k + 1)) = chamber[];
EndFor
Physical Volume("body") = body[];
Physical Surface("base") = Surface In BoundingBox{-cap_radius - e, -cap_radius - e, -e, cap_radius + e, cap_radius + e, e};
Physical Surface("tip") =
    Surface In BoundingBox{-cap_radius - e, -cap_radius - e, height - e, cap_radius + e, cap_radius + e, height + e};

Mesh.CharacteristicLengthMin = 7;
Mesh.CharacteristicLengthMax = 7;
Mesh.Optimize = 1;
Mesh.OptimizeThreshold = 0.6;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
