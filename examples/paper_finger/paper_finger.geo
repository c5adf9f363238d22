// PneuNet finger: a row of chambers on a channel, a sheet of paper in the belly; x along it, base at x = 0.
// Remesh: gmsh -3 paper_finger.geo -o paper_finger.msh
SetFactory("OpenCASCADE");

width = 16;  height = 14;
belly = 3;       // below the channel
paper = 1.5;     // height of the sheet in it
cap = 8;         // solid at the base
chambers = 6;
outer = 8;       // of a chamber along x
gap = 3;         // between two
wall = 1.5;      // between a chamber and the gap beside it, and at the sides
roof = 2;
channel_width = 3;  channel_height = 3;
length = cap + chambers * outer + (chambers - 1) * gap + 2;

solids[] = {};  airs[] = {};
v = newv;  Box(v) = {0, -width / 2, 0, length, width, paper};                                       below = v;
v = newv;  Box(v) = {0, -width / 2, paper, length, width, belly - paper + channel_height + 1.5};    solids[] += v;
v = newv;  Box(v) = {0, -width / 2, paper, cap, width, height - paper};                             solids[] += v;
For i In {0 : chambers - 1}
  x = cap + i * (outer + gap);
  v = newv;  Box(v) = {x, -width / 2, paper, outer, width, height - paper};                         solids[] += v;
  v = newv;  Box(v) = {x + wall, -width / 2 + wall, belly, outer - 2 * wall, width - 2 * wall, height - belly - roof};
  airs[] += v;
EndFor
v = newv;  Box(v) = {cap + wall, -channel_width / 2, belly, length - cap - 2 * wall - 2, channel_width, channel_height};  airs[] += v;

hull[] = BooleanUnion{ Volume{solids[0]}; Delete; }{ Volume{solids[{1 : #solids[] - 1}]}; Delete; };
air[] = BooleanUnion{ Volume{airs[0]}; Delete; }{ Volume{airs[{1 : #airs[] - 1}]}; Delete; };
BooleanFragments{ Volume{hull[], below}; Delete; }{ Volume{air[]}; Delete; }

e = 1e-3;
chamber[] = Volume In BoundingBox{cap + e, -width / 2 + e, belly - e, length - e, width / 2 - e, height - e};
body[] = Volume{:};
body[] -= chamber[];
Physical Volume("body") = body[];
Physical Volume("chamber") = chamber[];
Physical Surface("paper") = Surface In BoundingBox{-e, -width, paper - e, length + e, width, paper + e};
Physical Surface("base") = Surface In BoundingBox{-e, -width, -e, e, width, height + e};
Physical Surface("tip") = Surface In BoundingBox{length - e, -width, -e, length + e, width, height + e};

Mesh.CharacteristicLengthMin = 4.2;
Mesh.CharacteristicLengthMax = 4.2;
Mesh.Algorithm = 5;
Mesh.Optimize = 1;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
