// A strip of silicone on a thin film, along x, its base at x = 0.
// Remesh: gmsh -3 bilayer.geo -o bilayer.msh

length = 40;
width = 4;
film = 0.05;
rubber = 0.5;

Point(1) = {0, 0, 0};
Point(2) = {length, 0, 0};
Point(3) = {length, width, 0};
Point(4) = {0, width, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 21;
Transfinite Curve{2, 4} = 3;
Transfinite Surface{1} Alternate;

below[] = Extrude{0, 0, film}{ Surface{1}; Layers{1}; };
above[] = Extrude{0, 0, rubber}{ Surface{below[0]}; Layers{2}; };

Physical Volume("film") = {below[1]};
Physical Volume("rubber") = {above[1]};
Physical Surface("base") = {below[5], above[5]};
Physical Surface("end") = {below[3], above[3]};

Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
