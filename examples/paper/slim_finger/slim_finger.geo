// Slim pneumatic bellows finger, 120 x 25 x 12 mm, x along it, base at x = 0, flat floor at z = 0: that of
// examples/pneumatic_finger, less high. Remesh: gmsh -3 slim_finger.geo -o slim_finger.msh
// and with -clscale 0.42 for some 37,000 tetrahedra.
SetFactory("OpenCASCADE");

length = 120;
peak_width = 25;    peak_top = 12;    // outer section where a fold is widest
valley_width = 13;  valley_top = 6.5;  // and where it is narrowest
floor = 3.4;
wall_y = 1.6;  wall_z = 1.4;  // along y and z; 1.1 mm and 0.9 mm across the slanted walls
cap = 6;                      // solid block at either end
folds = 10;
half_pitch = (length - 2 * cap) / (2 * folds);

// Solid between a section at x1 and one at x2, each |y| <= w, bottom <= z <= t. Sets `solid`.
Macro Frustum
  p = newp;
  Point(p)     = {x1, -w1, bottom};  Point(p + 1) = {x1, w1, bottom};
  Point(p + 2) = {x1, w1, t1};       Point(p + 3) = {x1, -w1, t1};
  Point(p + 4) = {x2, -w2, bottom};  Point(p + 5) = {x2, w2, bottom};
  Point(p + 6) = {x2, w2, t2};       Point(p + 7) = {x2, -w2, t2};
  l = newl;
  For i In {0 : 3}
    Line(l + i) = {p + i, p + (i + 1) % 4};
    Line(l + 4 + i) = {p + 4 + i, p + 4 + (i + 1) % 4};
    Line(l + 8 + i) = {p + i, p + 4 + i};
  EndFor
  faces[] = {};
  c = newll;  Curve Loop(c) = {l, l + 1, l + 2, l + 3};          f = news;  Plane Surface(f) = {c};  faces[] += f;
  c = newll;  Curve Loop(c) = {l + 4, l + 5, l + 6, l + 7};      f = news;  Plane Surface(f) = {c};  faces[] += f;
  For i In {0 : 3}
    c = newll;
    Curve Loop(c) = {l + i, l + 8 + (i + 1) % 4, -(l + 4 + i), -(l + 8 + i)};
    f = news;  Plane Surface(f) = {c};  faces[] += f;
  EndFor
  s = newsl;  Surface Loop(s) = {faces[]};
  solid = newv;  Volume(solid) = {s};
Return

outer[] = {};
inner[] = {};
For fold In {0 : 2 * folds - 1}
  x1 = cap + fold * half_pitch;
  x2 = x1 + half_pitch;
  peak1 = fold % 2;  // is the section at x1 a peak
  For side In {0 : 1}
    w1 = (peak1 ? peak_width : valley_width) / 2 - side * wall_y;
    w2 = (peak1 ? valley_width : peak_width) / 2 - side * wall_y;
    t1 = (peak1 ? peak_top : valley_top) - side * wall_z;
    t2 = (peak1 ? valley_top : peak_top) - side * wall_z;
    bottom = floor;
    Call Frustum;
    If (side == 0)
      outer[] += solid;
    Else
      inner[] += solid;
    EndIf
  EndFor
EndFor

v = newv;  Box(v) = {0, -peak_width / 2, 0, length, peak_width, floor};                            outer[] += v;
v = newv;  Box(v) = {0, -peak_width / 2, floor, cap, peak_width, peak_top - floor};                outer[] += v;
v = newv;  Box(v) = {length - cap, -peak_width / 2, floor, cap, peak_width, peak_top - floor};     outer[] += v;

hull[] = BooleanUnion{ Volume{outer[0]}; Delete; }{ Volume{outer[{1 : #outer[] - 1}]}; Delete; };
air[] = BooleanUnion{ Volume{inner[0]}; Delete; }{ Volume{inner[{1 : #inner[] - 1}]}; Delete; };
BooleanFragments{ Volume{hull[]}; Delete; }{ Volume{air[]}; Delete; }

e = 1e-3;
chamber[] = Volume In BoundingBox{cap - e, -peak_width, floor - e, length - cap + e, peak_width, peak_top};
body[] = Volume{:};
body[] -= chamber[];
Physical Volume("body") = body[];
Physical Volume("chamber") = chamber[];
Physical Surface("base") = Surface In BoundingBox{-e, -peak_width, -e, e, peak_width, peak_top + e};
Physical Surface("tip") = Surface In BoundingBox{length - e, -peak_width, -e, length + e, peak_width, peak_top + e};
Physical Surface("cavity_wall") = Abs(Boundary{ Volume{chamber[]}; });

Mesh.CharacteristicLengthMin = 4.4;
Mesh.CharacteristicLengthMax = 4.4;
Mesh.Algorithm = 5;  // Delaunay: of the algorithms the one whose mesh is most alike on both sides of y = 0
Mesh.Optimize = 1;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;

