// A block of three layers side by side along x, mm: 30, 20 and 50 of 100 x 60, in 2D or, with a depth, in 3D:
// gmsh -2 layers.geo; gmsh -3 -setnumber depth 40 -setnumber h 12 layers.geo
SetFactory("OpenCASCADE");
DefineConstant[ h = 6, depth = 0 ];
Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
e = 1;
If (depth == 0)
  Rectangle(1) = {0, 0, 0, 30, 60};
  Rectangle(2) = {30, 0, 0, 20, 60};
  Rectangle(3) = {50, 0, 0, 50, 60};
  BooleanFragments{ Surface{1}; Delete; }{ Surface{2, 3}; Delete; }
  Physical Surface("left") = {1};
  Physical Surface("middle") = {2};
  Physical Surface("right") = {3};
  xmin() = Curve In BoundingBox{-e, -e, -e, e, 60 + e, e};
  xmax() = Curve In BoundingBox{100 - e, -e, -e, 100 + e, 60 + e, e};
  ymin() = Curve In BoundingBox{-e, -e, -e, 100 + e, e, e};
  ymax() = Curve In BoundingBox{-e, 60 - e, -e, 100 + e, 60 + e, e};
  Physical Curve("xmin") = {xmin()};
  Physical Curve("xmax") = {xmax()};
  Physical Curve("ymin") = {ymin()};
  Physical Curve("ymax") = {ymax()};
Else
  Box(1) = {0, 0, 0, 30, 60, depth};
  Box(2) = {30, 0, 0, 20, 60, depth};
  Box(3) = {50, 0, 0, 50, 60, depth};
  BooleanFragments{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; }
  Physical Volume("left") = {1};
  Physical Volume("middle") = {2};
  Physical Volume("right") = {3};
  xmin() = Surface In BoundingBox{-e, -e, -e, e, 60 + e, depth + e};
  xmax() = Surface In BoundingBox{100 - e, -e, -e, 100 + e, 60 + e, depth + e};
  ymin() = Surface In BoundingBox{-e, -e, -e, 100 + e, e, depth + e};
  ymax() = Surface In BoundingBox{-e, 60 - e, -e, 100 + e, 60 + e, depth + e};
  zmin() = Surface In BoundingBox{-e, -e, -e, 100 + e, 60 + e, e};
  zmax() = Surface In BoundingBox{-e, -e, depth - e, 100 + e, 60 + e, depth + e};
  Physical Surface("xmin") = {xmin()};
  Physical Surface("xmax") = {xmax()};
  Physical Surface("ymin") = {ymin()};
  Physical Surface("ymax") = {ymax()};
  Physical Surface("zmin") = {zmin()};
  Physical Surface("zmax") = {zmax()};
EndIf
