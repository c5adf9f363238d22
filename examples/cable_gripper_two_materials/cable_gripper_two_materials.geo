// Cable-driven gripper finger whose knuckles and segments can be of different materials: ../knuckle_finger.geo.
// Remesh: gmsh -3 cable_gripper_two_materials.geo -o cable_gripper_two_materials.msh
Include "../knuckle_finger.geo";

Physical Volume("segments") = segment[];
Physical Volume("knuckle1") = knuckle[0];  // nearest to the base
Physical Volume("knuckle2") = knuckle[1];
Physical Volume("knuckle3") = knuckle[2];
Physical Surface("base") = base[];
Physical Surface("tip") = tip[];
For i In {0 : 5}
  Physical Surface(Sprintf("eyelet%g", i + 1)) = eyelet[i];
EndFor
