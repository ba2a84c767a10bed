// A quarter of a cylinder, radius 0.05 m, height 0.1 m: gmsh -3 -setnumber h 0.01 bonded.geo
If (!Exists(h)) h = 0.01; EndIf
Point(1) = {0, 0, 0, h};
Point(2) = {0.05, 0, 0, h};
Point(3) = {0, 0.05, 0, h};
Line(1) = {1, 2};
Circle(2) = {2, 1, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};
made[] = Extrude {0, 0, 0.1} { Surface{1}; };
Physical Volume("body", 1) = {1};
Physical Surface("zmin", 11) = {1};
Physical Surface("zmax", 12) = {made[0]};
Physical Surface("ymin", 13) = {made[2]};
Physical Surface("side", 14) = {made[3]};
Physical Surface("xmin", 15) = {made[4]};
