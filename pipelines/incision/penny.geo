// A quarter of a block of 160 x 160 x 160 mm, size h mm about the disc of radius 10 mm in its middle plane, growing outwards.
SetFactory("OpenCASCADE");
DefineConstant[ h = 1 ];
Box(1) = {0, 0, -80, 80, 80, 160};
Physical Volume("body") = {1};
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm3D = 10;
beyond = "((Sqrt(x * x + y * y) - 11 + Fabs(Sqrt(x * x + y * y) - 11)) / 2)";
away = StrCat("(Sqrt(", beyond, " * ", beyond, Sprintf(" + z * z) - %g)", 2 * h));
Field[1] = MathEval;
Field[1].F = StrCat(Sprintf("%g + 0.175 * (", h), away, " + Fabs(", away, "))");
Background Field = 1;
