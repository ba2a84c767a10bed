// A block of soft tissue, 60 x 40, with a round lump in it; millimetres, axis y up.
// gmsh -2 block.geo -o block.msh
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 60, 40};
Disk(2) = {38, 24, 0, 8};
BooleanFragments{ Surface{1}; Delete; }{ Surface{2}; Delete; }

// What the scene refers to, one group per line: regions, and parts of the boundary.
Physical Surface("lump") = {2};
Physical Surface("tissue") = {3};
bottom() = Curve In BoundingBox{-1, -1, -1, 61, 1, 1};
top() = Curve In BoundingBox{-1, 39, -1, 61, 41, 1};
Physical Curve("bottom") = {bottom()};
Physical Curve("top") = {top()};

Mesh.MeshSizeMin = 2;
Mesh.MeshSizeMax = 2;
