// Bar of two materials, 100 x 20 x 10 mm, x along it, interface at x = 50, its end in a
// rigid grip, x = 100..105, and a block that pulls the grip, x = 105..125.
// Remesh: gmsh -3 two_material_bar.geo -o two_material_bar.msh
SetFactory("OpenCASCADE");

interface_x = 50;  length = 100;  grip = 5;  pull = 20;
width = 20;  height = 10;

Box(1) = {0, -width / 2, -height / 2, interface_x, width, height};
Box(2) = {interface_x, -width / 2, -height / 2, length - interface_x, width, height};
Box(3) = {length, -width / 2, -height / 2, grip, width, height};
Box(4) = {length + grip, -width / 2, -height / 2, pull, width, height};
BooleanFragments{ Volume{1 : 4}; Delete; }{}

e = 1e-3;
end = length + grip + pull;
Physical Volume("A") = {1};
Physical Volume("B") = {2};
Physical Volume("grip") = {3};
Physical Volume("pull") = {4};
Physical Surface("base") = Surface In BoundingBox{-e, -width, -height, e, width, height};
Physical Surface("interface") = Surface In BoundingBox{interface_x - e, -width, -height, interface_x + e, width, height};
Physical Surface("free_end") = Surface In BoundingBox{length - e, -width, -height, length + e, width, height};
Physical Surface("anchor") = Surface In BoundingBox{end - e, -width, -height, end + e, width, height};

Mesh.CharacteristicLengthMin = 4;
Mesh.CharacteristicLengthMax = 4;
Mesh.Optimize = 1;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
