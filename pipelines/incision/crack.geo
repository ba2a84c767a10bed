// A mesh whose nodes on the group 2 ("slit") are doubled, also where it ends on the group `open` of the rim (0: nowhere):
// gmsh -setstring mesh IN -setstring cracked OUT -setnumber across 1 or 2 -setnumber open 0 or 3 crack.geo -parse_and_exit
DefineConstant[ mesh = "", cracked = "", across = 1, open = 0 ];
Merge Str(mesh);
Plugin(Crack).Dimension = across;
Plugin(Crack).PhysicalGroup = 2;
Plugin(Crack).OpenBoundaryPhysicalGroup = open;
Plugin(Crack).Run;
Save Str(cracked);
