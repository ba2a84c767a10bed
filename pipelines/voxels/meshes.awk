# Tables of meshes.sh to one of means, a row for the meshes of gmsh and one for those from the image of each body: awk -f meshes.awk TABLE ...
# `ratio`: how far those from the image are from those of gmsh, by how far these are from each other.

BEGIN {
    FS = OFS = "\t"
    print "body", "mesh", "sizes_mm", "nodes", "off_mm", "apart_mm", "most_apart_mm", "ratio"
}

FNR == 1 { next }
$2 != mesh { tell(); body = $1; mesh = $2; first = $3; most = count = off = apart = 0; nodes = $4 }
{ last = $3; least = $4; off += $5; apart += $6; count++ }
$6 > most { most = $6 }
END { tell() }

function tell() {
    if (count == 0) return
    if (mesh == "gmsh") of_gmsh = apart / count
    print body, mesh, first " to " last, least " to " nodes, sprintf("%.4f", off / count), sprintf("%.4f", apart / count), \
        most, mesh == "gmsh" ? "-" : sprintf("%.2f", apart / count / of_gmsh)
}
