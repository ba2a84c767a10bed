// A ball of 24 mm with two openings, whose rims two balls cut: gmsh -3 ball.geo -setnumber h 5 (lengths in mm).
SetFactory("OpenCASCADE");
If (!Exists(h)) h = 5; EndIf
Sphere(1) = {0,0,0,24};
Sphere(2) = {0,0,28,14};
Sphere(3) = {0,0,-28,16};
top() = BooleanIntersection{ Surface{1}; }{ Volume{2}; };
bottom() = BooleanIntersection{ Surface{1}; }{ Volume{3}; };
rest() = BooleanDifference{ Surface{1}; }{ Volume{2,3}; };
Recursive Delete { Volume{1,2,3}; }
Coherence;
Surface Loop(10) = {top(), bottom(), rest()};
Volume(10) = {10};
Physical Volume("ball") = {10};
Physical Surface("top") = {top()};
Physical Surface("bottom") = {bottom()};
Physical Surface("rest") = {rest()};
Mesh.MeshSizeMax = h; Mesh.MeshSizeMin = h;
