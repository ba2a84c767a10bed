// A bar of silicone, round, fixed at z = 0. Millimetres.
// Its section is a polygon of n sides with the area of the circle: it bends under its weight as the circle does.
DefineConstant[ h = 2.5 ];
length = 182;
n = Ceil(2 * Pi * 4.25 / h);
radius = 4.25 * Sqrt((2 * Pi / n) / Sin(2 * Pi / n));
For i In {0 : n - 1}
    Point(i + 1) = {radius * Cos(2 * Pi * i / n), radius * Sin(2 * Pi * i / n), 0, h};
EndFor
For i In {1 : n}
    Line(i) = {i, (i % n) + 1};
EndFor
Curve Loop(1) = {1:n};
Plane Surface(1) = {1};
made() = Extrude {0, 0, length} { Surface{1}; };
Mesh.MeshSizeFromPoints = 1;
Physical Volume("silicone") = {made(1)};
Physical Surface("clamp") = {1};
Physical Surface("tip") = {made(0)};
