// A cube of 0.1 m: gmsh -3 -setnumber h 0.01 cube.geo
If (!Exists(h)) h = 0.01; EndIf
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 0.1, 0.1, 0.1};
MeshSize{ PointsOf{ Volume{1}; } } = h;
Physical Volume("body", 1) = {1};
Physical Surface("zmin", 15) = {5};
Physical Surface("zmax", 16) = {6};
