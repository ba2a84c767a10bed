// A square block of 0.1 m: gmsh -2 -setnumber h 0.004 square.geo
If (!Exists(h)) h = 0.004; EndIf
Point(1) = {0, 0, 0, h};
Point(2) = {0.1, 0, 0, h};
Point(3) = {0.1, 0.1, 0, h};
Point(4) = {0, 0.1, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Surface("body", 1) = {1};
Physical Curve("ymin", 11) = {1};
Physical Curve("xmax", 12) = {2};
Physical Curve("ymax", 13) = {3};
Physical Curve("xmin", 14) = {4};
