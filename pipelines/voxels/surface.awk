# Triangles of a mesh of gmsh (MSH 2), rows of nine numbers: awk -f surface.awk -v first=TAG -v last=TAG MESH, those of surfaces with such tags.

/^\$/ { part = $1; next }
part == "$Nodes" { place[$1] = $2 "\t" $3 "\t" $4 }
part == "$Elements" && $2 == 2 && $5 >= first && $5 <= last { print place[$(NF - 2)] "\t" place[$(NF - 1)] "\t" place[$NF] }
