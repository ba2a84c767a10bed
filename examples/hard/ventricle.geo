// The wall of a ventricle, a truncated ellipsoid (Land et al. 2015, problems 2 and 3), in mm: radii 7 and 17 inside, 10 and 20
// outside, cut at z = 5. h: size of the cells.
SetFactory("OpenCASCADE");
If (!Exists(h)) h = 2; EndIf
Sphere(1) = {0, 0, 0, 1};
Dilate {{0, 0, 0}, {10, 10, 20}} { Volume{1}; }
Sphere(2) = {0, 0, 0, 1};
Dilate {{0, 0, 0}, {7, 7, 17}} { Volume{2}; }
Box(3) = {-30, -30, 5, 60, 60, 40};
BooleanDifference(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Mesh.MeshSizeMax = h;
Mesh.MeshSizeMin = h;
Physical Surface("base") = {2};
Physical Surface("inside") = {3};
Physical Volume("body") = {4};
