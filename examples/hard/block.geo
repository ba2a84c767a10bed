// A square block of 0.1 m: gmsh -2 -setnumber h 0.005 block.geo; metres.
If (!Exists(h)) h = 0.005; EndIf
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
Physical Curve("ymax", 12) = {3};
