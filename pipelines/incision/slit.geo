// A plate of 80 x 80 mm, size h mm within 13 mm of its middle, growing outwards.
SetFactory("OpenCASCADE");
DefineConstant[ h = 1 ];
Rectangle(1) = {-40, -40, 0, 80, 80};
Physical Surface("body") = {1};
Physical Curve("rim") = {1, 2, 3, 4};
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.0625 * (Sqrt(x * x + y * y) - 13 + Fabs(Sqrt(x * x + y * y) - 13))", h);
Background Field = 1;
