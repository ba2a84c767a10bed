// A quarter of a square block of 0.1 m bonded to plates, cut at its lines of symmetry: gmsh -2 -setnumber h 0.004 block.geo; a
// share of h at the corner of the plate, where the stress is singular: -setnumber rim 0.2.
If (!Exists(h)) h = 0.004; EndIf
If (!Exists(rim)) rim = 0.2; EndIf
Point(1) = {0, 0, 0, h};
Point(2) = {0.05, 0, 0, h};
Point(3) = {0.05, 0.05, 0, rim * h};
Point(4) = {0, 0.05, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Surface("body", 1) = {1};
Physical Curve("middle", 11) = {1};
Physical Curve("xmax", 12) = {2};
Physical Curve("plate", 13) = {3};
Physical Curve("xmin", 14) = {4};
