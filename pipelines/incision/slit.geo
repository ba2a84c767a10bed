// A plate of 80 x 80 mm, size h mm within 13 mm of its middle, growing outwards; with `meshed` the slit is a line of the mesh, "slit".
SetFactory("OpenCASCADE");
DefineConstant[ h = 1, meshed = 0 ];
Rectangle(1) = {-40, -40, 0, 80, 80};
If(meshed)
  Point(11) = {-10, 0, 0};
  Point(12) = {10, 0, 0};
  Line(11) = {11, 12};
  BooleanFragments{ Surface{1}; Delete; }{ Curve{11}; Delete; }
  Physical Curve("slit", 2) = {11};
EndIf
Physical Surface("body") = {1};
Physical Curve("rim") = Boundary{ Surface{1}; };
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.0625 * (Sqrt(x * x + y * y) - 13 + Fabs(Sqrt(x * x + y * y) - 13))", h);
Background Field = 1;
