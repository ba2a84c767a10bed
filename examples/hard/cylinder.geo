// A quarter of a thick cylinder's section, radii 1 and 2 m: gmsh -2 -setnumber n 12 cylinder.geo, n elements along the inner
// quarter circle; `ratio` times as large outside: twice, or by -setnumber ratio.
If (!Exists(n)) n = 12; EndIf
If (!Exists(ratio)) ratio = 2; EndIf
h = 1.5708 / n;
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0, h};
Point(3) = {2, 0, 0, ratio * h};
Point(4) = {0, 2, 0, ratio * h};
Point(5) = {0, 1, 0, h};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Surface("body", 1) = {1};
Physical Curve("outer", 11) = {2};
Physical Curve("inner", 12) = {4};
Physical Curve("ymin", 13) = {1};
Physical Curve("xmin", 14) = {3};
