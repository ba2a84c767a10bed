// A quarter of a block of 160 x 160 x 160 mm, size h mm about the disc of radius 10 mm in its middle plane, growing outwards; with `meshed` the disc is a
// surface of the mesh, "slit", which opens on the curves "open".
SetFactory("OpenCASCADE");
DefineConstant[ h = 1, meshed = 0 ];
Box(1) = {0, 0, -80, 80, 80, 160};
If(meshed)
  Disk(100) = {0, 0, 0, 10};
  quarter() = BooleanIntersection{ Surface{100}; Delete; }{ Volume{1}; };
  BooleanFragments{ Volume{1}; Delete; }{ Surface{quarter()}; Delete; }
  Physical Surface("slit", 2) = {quarter()};
  along() = Curve In BoundingBox{-1, -1, -1, 11, 1, 1};
  along() += Curve In BoundingBox{-1, -1, -1, 1, 11, 1};
  Physical Curve("open", 3) = along();
EndIf
Physical Volume("body") = {1};
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm3D = 10;
beyond = "((Sqrt(x * x + y * y) - 11 + Fabs(Sqrt(x * x + y * y) - 11)) / 2)";
away = StrCat("(Sqrt(", beyond, " * ", beyond, Sprintf(" + z * z) - %g)", 2 * h));
Field[1] = MathEval;
Field[1].F = StrCat(Sprintf("%g + 0.175 * (", h), away, " + Fabs(", away, "))");
Background Field = 1;
