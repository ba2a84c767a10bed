// The wall of a ventricle, a truncated ellipsoid (Land et al. 2015, problems 2 and 3), in mm: radii 7 and 17 inside, 10 and 20
// outside, cut at z = 5. h: size of the cells; quarter: 1 for the part at positive x and y.
SetFactory("OpenCASCADE");
If (!Exists(h)) h = 2; EndIf
If (!Exists(quarter)) quarter = 0; EndIf
Sphere(1) = {0, 0, 0, 1};
Dilate {{0, 0, 0}, {10, 10, 20}} { Volume{1}; }
Sphere(2) = {0, 0, 0, 1};
Dilate {{0, 0, 0}, {7, 7, 17}} { Volume{2}; }
Box(3) = {-30, -30, 5, 60, 60, 40};
BooleanDifference(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Mesh.MeshSizeMax = h;
Mesh.MeshSizeMin = h;
If (quarter)
  Box(5) = {0, 0, -40, 60, 60, 80};
  BooleanIntersection(6) = { Volume{4}; Delete; }{ Volume{5}; Delete; };
  Physical Surface("base") = {2};
  Physical Surface("symmetry") = {3, 4};
  Physical Surface("inside") = {5};
  Physical Volume("body") = {6};
Else
  Physical Surface("base") = {2};
  Physical Surface("inside") = {3};
  Physical Volume("body") = {4};
EndIf
