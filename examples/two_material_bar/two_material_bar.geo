// Bar of two materials, 100 x 20 x 10 mm, x along it, interface at x = 50.
// Remesh: gmsh -3 two_material_bar.geo -o two_material_bar.msh
SetFactory("OpenCASCADE");

interface_x = 50;  length = 100;
width = 20;  height = 10;

Box(1) = {0, -width / 2, -height / 2, interface_x, width, height};
Box(2) = {interface_x, -width / 2, -height / 2, length - interface_x, width, height};
BooleanFragments{ Volume{1 : 2}; Delete; }{}

e = 1e-3;
Physical Volume("A") = {1};
Physical Volume("B") = {2};
Physical Surface("base") = Surface In BoundingBox{-e, -width, -height, e, width, height};
Physical Surface("interface") = Surface In BoundingBox{interface_x - e, -width, -height, interface_x + e, width, height};
Physical Surface("free_end") = Surface In BoundingBox{length - e, -width, -height, length + e, width, height};

Mesh.CharacteristicLengthMin = 4;
Mesh.CharacteristicLengthMax = 4;
Mesh.Optimize = 1;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
