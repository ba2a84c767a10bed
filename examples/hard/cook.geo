// Cook's membrane, 48 m long, 44 m high at the clamped end and 16 m at the loaded one: gmsh -2 -setnumber h 2 cook.geo
If (!Exists(h)) h = 2; EndIf
Point(1) = {0, 0, 0, h};
Point(2) = {48, 44, 0, h};
Point(3) = {48, 52, 0, h};
Point(4) = {48, 60, 0, h};
Point(5) = {0, 44, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 1};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};
Physical Surface("body", 1) = {1};
Physical Curve("loaded", 11) = {2, 3};
Physical Curve("clamped", 12) = {5};
