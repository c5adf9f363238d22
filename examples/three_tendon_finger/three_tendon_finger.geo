// Finger with three knuckles, each with a tendon of its own: the shape of ../knuckle_finger.geo.
// Remesh: gmsh -3 three_tendon_finger.geo -o three_tendon_finger.msh
Include "../knuckle_finger.geo";

Physical Volume("body") = {segment[], knuckle[]};
Physical Surface("base") = base[];
Physical Surface("tip") = tip[];
For i In {0 : 5}
  Physical Surface(Sprintf("eyelet%g", i + 1)) = eyelet[i];
EndFor
