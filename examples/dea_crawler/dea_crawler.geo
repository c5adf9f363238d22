// Crawling robot: a dielectric elastomer membrane under a PET frame, two rigid legs; 90 x 40 x 11 mm, feet at z = 0.
// Every element is a prism: one triangulated plan, extruded in layers.
// Remesh: gmsh -3 dea_crawler.geo -o dea_crawler.msh
SetFactory("OpenCASCADE");

length = 90;  width = 40;
leg = 5;             // length of a leg along x
bridge = 10;         // from a leg to the frame, along x
bridge_width = 12;
bar = 5;             // width of the frame's strips
leg_height = 9.5;    // below the membrane
membrane = 0.5;      // thickness of the lower layer: the membrane in the window, PET elsewhere
pet = 1;             // thickness of the upper layer: PET
size = 3.5;

x2 = leg + bridge;
x3 = x2 + bar;
Rectangle(1) = {0, -width / 2, leg_height, leg, width};
Rectangle(2) = {length - leg, -width / 2, leg_height, leg, width};
Rectangle(3) = {leg, -bridge_width / 2, leg_height, bridge, bridge_width};
Rectangle(4) = {length - x2, -bridge_width / 2, leg_height, bridge, bridge_width};
Rectangle(5) = {x2, -width / 2, leg_height, length - 2 * x2, width};
Rectangle(6) = {x3, -width / 2 + bar, leg_height, length - 2 * x3, width - 2 * bar};
BooleanFragments{ Surface{1 : 6}; Delete; }{}

e = 1e-3;
top = leg_height + membrane + pet;
Macro Legs  // what lies in the footprint of a leg, z1 <= z <= z2: surfaces in footprint[], volumes in left[], right[]
  footprint[] = {};
  footprint[] += Surface In BoundingBox{-e, -width, z1 - e, leg + e, width, z2 + e};
  footprint[] += Surface In BoundingBox{length - leg - e, -width, z1 - e, length + e, width, z2 + e};
  left[] = {};
  left[] += Volume In BoundingBox{-e, -width, z1 - e, leg + e, width, z2 + e};
  right[] = {};
  right[] += Volume In BoundingBox{length - leg - e, -width, z1 - e, length + e, width, z2 + e};
Return

// Lower layer everywhere, PET layer above it outside the window, legs below. One Extrude for each, so that
// neighbours share their sides.
z1 = leg_height;  z2 = leg_height;
Call Legs;
plan[] = Surface{:};
Extrude {0, 0, membrane} { Surface{plan[]}; Layers{1}; Recombine; }
x4 = length - x3;
y = width / 2 - bar;
upper[] = Surface In BoundingBox{-e, -width, z1 + membrane - e, length + e, width, z1 + membrane + e};
upper[] -= Surface In BoundingBox{x3 - e, -y - e, z1 + membrane - e, x4 + e, y + e, z1 + membrane + e};
Extrude {0, 0, pet} { Surface{upper[]}; Layers{1}; Recombine; }
Extrude {0, 0, -leg_height} { Surface{footprint[]}; Layers{3}; Recombine; }

z1 = 0;  z2 = top;
Call Legs;
skin[] = Volume In BoundingBox{x3 - e, -y - e, 0, x4 + e, y + e, top};
stiff[] = Volume{:};
stiff[] -= left[];
stiff[] -= right[];
stiff[] -= skin[];
Physical Volume("membrane") = skin[];
Physical Volume("frame") = stiff[];
Physical Volume("leg1") = left[];
Physical Volume("leg2") = right[];
Physical Surface("foot1") = Surface In BoundingBox{-e, -width, -e, leg + e, width, e};
Physical Surface("foot2") = Surface In BoundingBox{length - leg - e, -width, -e, length + e, width, e};

Mesh.CharacteristicLengthMin = size;
Mesh.CharacteristicLengthMax = size;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
