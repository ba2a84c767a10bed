// A quarter of a cylinder of tissue, 30 mm across and 10 mm high, between plates at "bottom" and "top". Millimetres.
SetFactory("OpenCASCADE");
DefineConstant[ h = 3 ];
Cylinder(1) = {0, 0, 0, 0, 0, 10, 15, Pi / 2};
Mesh.MeshSizeMax = h;
Mesh.MeshSizeMin = h;
e = 1e-3;
Physical Volume("tissue") = {1};
Physical Surface("bottom") = Surface In BoundingBox{-e, -e, -e, 16, 16, e};
Physical Surface("top") = Surface In BoundingBox{-e, -e, 10 - e, 16, 16, 10 + e};
Physical Surface("xmin") = Surface In BoundingBox{-e, -e, -e, e, 16, 10 + e};
Physical Surface("ymin") = Surface In BoundingBox{-e, -e, -e, 16, e, 10 + e};
