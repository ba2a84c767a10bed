// The eighth of a ball of three layers, radii .04, .07 and .1 m: gmsh -3 -setnumber h 0.0071 ball.geo
SetFactory("OpenCASCADE");
DefineConstant[ h = 0.01 ];
Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
e = 1e-6;
Sphere(1) = {0, 0, 0, 0.1, 0, Pi/2, Pi/2};
Sphere(2) = {0, 0, 0, 0.07, 0, Pi/2, Pi/2};
Sphere(3) = {0, 0, 0, 0.04, 0, Pi/2, Pi/2};
BooleanDifference(11) = { Volume{1}; Delete; }{ Volume{2}; };
BooleanDifference(12) = { Volume{2}; Delete; }{ Volume{3}; };
BooleanFragments{ Volume{11}; Delete; }{ Volume{12, 3}; Delete; }
Physical Volume("outer") = {11};
Physical Volume("shell") = {12};
Physical Volume("core") = {3};
x() = Surface In BoundingBox{-e, -e, -e, e, 0.2, 0.2};
y() = Surface In BoundingBox{-e, -e, -e, 0.2, e, 0.2};
z() = Surface In BoundingBox{-e, -e, -e, 0.2, 0.2, e};
Physical Surface("planes") = {x(), y(), z()};
all() = CombinedBoundary{ Volume{11, 12, 3}; };
s() = Abs(all());
s() -= {x(), y(), z()};
Physical Surface("surface") = {s()};
