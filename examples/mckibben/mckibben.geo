// McKibben muscle: a thin tube of rubber along x with solid ends, base at x = 0; its braid is in the scene.
// Remesh: gmsh -3 mckibben.geo -o mckibben.msh
SetFactory("OpenCASCADE");

length = 80;
radius = 7;
bore = 6;
cap = 5;  // solid at either end

Cylinder(1) = {0, 0, 0, length, 0, 0, radius};
Cylinder(2) = {cap, 0, 0, length - 2 * cap, 0, 0, bore};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }

e = 1e-3;
chamber[] = Volume In BoundingBox{cap - e, -bore - e, -bore - e, length - cap + e, bore + e, bore + e};
body[] = Volume{:};
body[] -= chamber[];
Physical Volume("chamber") = chamber[];
Physical Volume("body") = body[];
Physical Surface("base") = Surface In BoundingBox{-e, -radius - e, -radius - e, e, radius + e, radius + e};
Physical Surface("tip") = Surface In BoundingBox{length - e, -radius - e, -radius - e, length + e, radius + e, radius + e};

Mesh.CharacteristicLengthMin = 4;
Mesh.CharacteristicLengthMax = 4;
Mesh.Optimize = 1;
Mesh.OptimizeThreshold = 0.6;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
