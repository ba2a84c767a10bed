// The liver, mm, made of the triangles of liver_surface.stl, which gmsh meshes anew.
DefineConstant[ lc = 13 ];
Merge "liver_surface.stl";
Mesh.Algorithm3D = 1;
ClassifySurfaces{ 40 * Pi / 180, 1, 1, Pi };
CreateGeometry;
surfaces() = Surface{:};
Surface Loop(1) = surfaces();
Volume(1) = {1};
Physical Volume("liver") = {1};
Physical Surface("capsule") = surfaces();
Mesh.MeshSizeMin = lc;
Mesh.MeshSizeMax = lc;
Mesh.MeshSizeExtendFromBoundary = 1;
