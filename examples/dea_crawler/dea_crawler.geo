// Crawling robot: a dielectric elastomer membrane between two rigid legs, as the string of a bow, and above it a PET
// frame, the bow; 90 x 40 x 18 mm, feet at z = 0. Every element is a prism: triangulated sheets, extruded along z.
// Remesh: gmsh -3 dea_crawler.geo -o dea_crawler.msh
SetFactory("OpenCASCADE");

length = 90;  width = 40;
leg = 8;          // length of a leg along x
rail = 8;         // width of the frame's rails, one along either side
rise = 7;         // of the bow at rest, which picks the side to which it bends
pet = 2;          // thickness of the frame
frame_z = 9;      // its underside at the legs
membrane_z = 4.5; // upper side of the membrane
membrane = 0.5;   // its thickness
size = 3.5;

// The underside of the frame: rails and three rungs. Each piece of the bow is swept across the whole width, in three
// strips, of which the middle one is kept where there is a rung.
cut_x[] = {leg, 25, 30, 42.5, 47.5, 60, 65, length - leg};
sheets[] = {};
For k In {0 : 6}
  p = newp;
  For i In {0 : 6}
    x = cut_x[k] + (cut_x[k + 1] - cut_x[k]) * i / 6;
    Point(p + i) = {x, -width / 2, frame_z + rise / 2 * (1 - Cos(2 * Pi * (x - leg) / (length - 2 * leg)))};
  EndFor
  l = newl;  Spline(l) = {p : p + 6};
  side[] = Extrude {0, rail, 0} { Curve{l}; };
  sheets[] += {side[1]};
  middle[] = Extrude {0, width - 2 * rail, 0} { Curve{side[0]}; };
  If (k % 2)
    sheets[] += {middle[1]};
  Else
    Recursive Delete { Surface{middle[1]}; }
  EndIf
  across[] = Translate {0, width - rail, 0} { Duplicata { Surface{side[1]}; } };
  sheets[] += {across[]};
EndFor
feet[] = {};
For i In {0 : 1}
  x = i ? length - leg : 0;
  s = news;  Rectangle(s) = {x, -width / 2, frame_z, leg, width};
  feet[] += {s};
EndFor
BooleanFragments{ Surface{sheets[], feet[]}; Delete; }{}

e = 1e-3;
Macro Feet  // footprint[]: the legs' sections at z1
  footprint[] = Surface In BoundingBox{-e, -width, z1 - e, leg + e, width, z1 + e};
  footprint[] += Surface In BoundingBox{length - leg - e, -width, z1 - e, length + e, width, z1 + e};
Return

z1 = frame_z;
Call Feet;
upper[] = Surface{:};

// A plan of the membrane that ends in the legs' own edges. It is swept down with the legs; what it sweeps above and
// below the membrane belongs to no region and is left out of the mesh file.
y[] = {-width / 2, rail - width / 2, width / 2 - rail, width / 2};
start[] = {};
end[] = {};
For i In {0 : 2}
  start[] += Curve In BoundingBox{leg - e, y[i] - e, z1 - e, leg + e, y[i + 1] + e, z1 + e};
  end[] += Curve In BoundingBox{length - leg - e, y[i] - e, z1 - e, length - leg + e, y[i + 1] + e, z1 + e};
EndFor
sides[] = {};
For i In {0 : 3 : 3}
  p1[] = Point In BoundingBox{leg - e, y[i] - e, z1 - e, leg + e, y[i] + e, z1 + e};
  p2[] = Point In BoundingBox{length - leg - e, y[i] - e, z1 - e, length - leg + e, y[i] + e, z1 + e};
  l = newl;  Line(l) = {p1[0], p2[0]};
  sides[] += {l};
EndFor
c = newll;  Curve Loop(c) = {sides[0], end[], sides[1], start[{2, 1, 0}]};
s = news;   Plane Surface(s) = {c};

Extrude {0, 0, pet} { Surface{upper[]}; Layers{1}; Recombine; }
cuts[] = {frame_z, membrane_z, membrane_z - membrane, 0};
lower[] = {footprint[], s};
For i In {0 : 2}
  Extrude {0, 0, cuts[i + 1] - cuts[i]} { Surface{lower[]}; Layers{1 + (i != 1)}; Recombine; }
  lower[] = Surface In BoundingBox{-e, -width, cuts[i + 1] - e, length + e, width, cuts[i + 1] + e};
EndFor

top = frame_z + rise + pet;
leg1[] = Volume In BoundingBox{-e, -width, -e, leg + e, width, top};
leg2[] = Volume In BoundingBox{length - leg - e, -width, -e, length + e, width, top};
skin[] = Volume In BoundingBox{leg - e, -width, cuts[2] - e, length - leg + e, width, membrane_z + e};
frame[] = Volume In BoundingBox{leg - e, -width, frame_z - e, length - leg + e, width, top + e};
Physical Volume("membrane") = skin[];
Physical Volume("frame") = frame[];
Physical Volume("leg1") = leg1[];
Physical Volume("leg2") = leg2[];
Physical Surface("foot1") = Surface In BoundingBox{-e, -width, -e, leg + e, width, e};
Physical Surface("foot2") = Surface In BoundingBox{length - leg - e, -width, -e, length + e, width, e};

Mesh.CharacteristicLengthMin = size;
Mesh.CharacteristicLengthMax = size;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
