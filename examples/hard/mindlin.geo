// Half of a block of 120 x 120 x 60 mm, fine where a ball touches its top: gmsh -3 -setnumber h 1.6 mindlin.geo
SetFactory("OpenCASCADE");
DefineConstant[ h = 1.6 ];
Box(1) = {-60, 0, -60, 120, 60, 60};
e = 1e-3;
Physical Volume("body") = {1};
bottom() = Surface In BoundingBox{-61, -e, -60 - e, 61, 61, -60 + e};
top() = Surface In BoundingBox{-61, -e, -e, 61, 61, e};
middle() = Surface In BoundingBox{-61, -e, -61, 61, e, 1};
Physical Surface("bottom") = {bottom()};
Physical Surface("top") = {top()};
Physical Surface("middle") = {middle()};
Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.125 * (Sqrt(x*x + y*y + z*z) - 11 + Fabs(Sqrt(x*x + y*y + z*z) - 11))", h);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
