// Cable-driven gripper finger of one material: the shape of ../knuckle_finger.geo.
// Remesh: gmsh -3 cable_gripper.geo -o cable_gripper.msh
Include "../knuckle_finger.geo";

Physical Volume("body") = {segment[], knuckle[]};
Physical Surface("base") = base[];
Physical Surface("tip") = tip[];
For i In {0 : 5}
  Physical Surface(Sprintf("eyelet%g", i + 1)) = eyelet[i];
EndFor
