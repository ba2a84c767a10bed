# The input deck of a scene for CalculiX, with one of deck2d.awk and deck3d.awk for the conditions in that dimension:
#
#     awk -f pipelines/stream.awk -f pipelines/scene.awk -f pipelines/table.awk -f deck.awk -f deck3d.awk -v scene=FILE -v mesh=STREAM [-v increment=PART] [-v solver=NAME] > FILE.inp
#
# STREAM (text) holds what `nodes` writes. Its triangles become quadratic plane strain elements (CPE6), its tetrahedra
# quadratic ones (C3D10), with the mid-nodes on the straight edges, so that nodes 1..N are those of the stream and the
# geometry is the same. Understood of a scene: neo-Hookean materials of one region each, displacements by table or by
# components on one group of facets, in 2D contact of one group with a rigid curve, and tractions; anything else in it is an error. SI units, in
# 2D per metre of thickness. The load is applied in increments of at most PART of it (0.1).

BEGIN {
    if (increment == "") increment = 0.1
    read_scene(scene)
    read_stream(mesh, "")
    need_section("nodes.x", "run nodes")
    need_section("facets", "run nodes")
    dim = cols["nodes.x"]
    if (scene_value["scene", "dim"] != dim || dim != deck_dim() || cols["cells"] != dim + 1)
        die(scene ": not a scene in the " dim " dimensions of " mesh)

    print "** " scene (dim == 2 ? ", plane strain" : "") ", SI units"
    print_nodes()
    print_elements()
    for (k = 1; k <= section_count; k++) if (kind[k] == "material") print_material(k)
    else if (kind[k] !~ /^(displacement|contact|traction|solver|output)$/) die(scene ": section [" kind[k] "] is not understood")
    for (k = 1; k <= section_count; k++) if (kind[k] == "displacement") collect_displacement(k)
    for (k = 1; k <= section_count; k++) if (kind[k] == "contact") print_contact(k)
    print "*NSET,NSET=CORNERS,GENERATE"
    print "1," rows["nodes.x"] ",1"
    print "*STEP,NLGEOM,INC=2000"
    print "*STATIC" (solver == "" ? "" : ", SOLVER=" solver)
    printf "%g,1.,1.E-7,%g\n", increment / 2, increment
    print "*BOUNDARY"
    for (k = 1; k <= prescribed_count; k++) print prescribed[k]
    for (k = 1; k <= section_count; k++) if (kind[k] == "traction") print_traction(k)
    print "*NODE PRINT,NSET=CORNERS"
    print "U"
    for (k = 1; k <= section_count; k++) if (kind[k] == "displacement") {
        print "*NODE PRINT,NSET=MOVED_" toupper(label[k]) ",TOTALS=ONLY"
        print "RF"
    }
    print "*END STEP"
}

# ---- mesh ------------------------------------------------------------------------------------------------------------

# The number of the mid-node of edge a-b (deck numbers, from 1).
function middle(a, b,    low, high, d) {
    low = a < b ? a : b
    high = a < b ? b : a
    if (!((low, high) in mid)) {
        mid[low, high] = ++node_count
        for (d = 1; d <= dim; d++) x[node_count, d] = (x[a, d] + x[b, d]) / 2
    }
    return mid[low, high]
}

# What names an edge, or a triangle, whatever the order of its nodes.
function face_key(a, b, c,    t) {
    if (b < a) { t = a; a = b; b = t }
    if (dim == 2) return a " " b
    if (c < b) { t = b; b = c; c = t }
    if (b < a) { t = a; a = b; b = t }
    return a " " b " " c
}

# Edges in the order in which the mid-nodes follow the corners of an element, and its faces S1, S2, ...
function describe_element() {
    edge_count = split(dim == 2 ? "1 2 2 3 3 1" : "1 2 2 3 3 1 1 4 2 4 3 4", edge_end) / 2
    face_count = split(dim == 2 ? "1 2 0 2 3 0 3 1 0" : "1 2 3 1 4 2 2 4 3 3 4 1", face_corner) / 3
}

function print_nodes(    i, c, d, e, f) {
    describe_element()
    node_count = rows["nodes.x"]
    for (i = 1; i <= node_count; i++)
        for (d = 1; d <= dim; d++) x[i, d] = value["nodes.x", i - 1, d - 1] + 0
    for (c = 0; c < rows["cells"]; c++) {
        for (i = 1; i <= dim + 1; i++) corner[i] = value["cells", c, i - 1] + 1
        for (e = 1; e <= edge_count; e++) middle(corner[edge_end[2 * e - 1]], corner[edge_end[2 * e]])
        for (f = 1; f <= face_count; f++)
            side_of[face_key(corner[face_corner[3 * f - 2]], corner[face_corner[3 * f - 1]], corner[face_corner[3 * f]])] = \
                (c + 1) ",S" f
    }
    print "*NODE,NSET=BODY"
    for (i = 1; i <= node_count; i++) print i coordinates(i)
}

function coordinates(i,    d, text) {
    for (d = 1; d <= dim; d++) text = text sprintf(",%.9g", x[i, d])
    return text
}

function print_elements(    names, count, g, c, i, e, text) {
    count = split(attribute["cells.region", "names"], names, ",")
    for (g = 1; g <= count; g++) {
        print "*ELEMENT,TYPE=" (dim == 2 ? "CPE6" : "C3D10") ",ELSET=" toupper(names[g])
        for (c = 0; c < rows["cells"]; c++) {
            if (value["cells.region", c, 0] != g - 1) continue
            text = c + 1
            for (i = 1; i <= dim + 1; i++) text = text "," (corner[i] = value["cells", c, i - 1] + 1)
            for (e = 1; e <= edge_count; e++) text = text "," middle(corner[edge_end[2 * e - 1]], corner[edge_end[2 * e]])
            print text
        }
    }
    element_count = rows["cells"]
}

# W = mu/2 (J^(-2/3) I1 - 3) + kappa/2 (J - 1)^2: C10 = mu/2, D1 = 2/kappa.
function print_material(k,    E, nu) {
    if (scene_value[k, "model"] !~ /^(neo-hookean)?$/) die(scene ": only neo-Hookean materials")
    E = scene_value[k, "E"]
    nu = scene_value[k, "nu"]
    name_index("cells.region", scene_value[k, "region"])
    print "*MATERIAL,NAME=M_" toupper(label[k])
    print "*HYPERELASTIC,NEO HOOKE"
    printf "%.9g,%.9g\n", E / (4 * (1 + nu)), 6 * (1 - 2 * nu) / E
    print "*SOLID SECTION,ELSET=" toupper(scene_value[k, "region"]) ",MATERIAL=M_" toupper(label[k])
}

# ---- displacements and contact ---------------------------------------------------------------------------------------

# The prescribed displacements of the nodes of a group, mid-nodes too, go to prescribed[1..prescribed_count].
function collect_displacement(k,    n, set, f, i, j, list) {
    n = (k, "table") in scene_value ? read_table(k, "table", 2 * dim) : 0
    set = name_index("facets.set", scene_value[k, "facets"])
    print "*NSET,NSET=MOVED_" toupper(label[k])
    for (f = 0; f < rows["facets"]; f++) {
        if (value["facets.set", f, 0] != set) continue
        for (i = 0; i < dim; i++) {
            prescribe(k, value["facets", f, i] + 1, n)
            for (j = 0; j < i; j++) prescribe(k, middle(value["facets", f, i] + 1, value["facets", f, j] + 1), n)
        }
    }
}

# Prescribe node i: by the components, or by the table of n rows (see table_at, per dimension).
function prescribe(k, i, n,    u, d) {
    if (i in is_prescribed) return
    is_prescribed[i] = 1
    print i
    if (n > 0) table_at(i, n, u)
    else if (split(scene_value[k, "components"], u, /[ \t]*,[ \t]*/) != dim || scene_value[k, "components"] ~ /free/)
        die(scene ": only displacements by table or by all components")
    for (d = 1; d <= dim; d++) prescribed[++prescribed_count] = sprintf("%d,%d,%d,%.9g", i, d, d, u[d])
}

# A dead load along edges: the forces of a constant traction on the three nodes of each.
function print_traction(k,    f, a, b, d, length_, t, node) {
    if (dim != 2 || split(scene_value[k, "components"], t, /[ \t]*,[ \t]*/) != 2) die(scene ": only tractions of two components in 2D")
    print "*CLOAD"
    for (f = 0; f < rows["facets"]; f++) {
        if (value["facets.set", f, 0] != name_index("facets.set", scene_value[k, "facets"])) continue
        node[1] = a = value["facets", f, 0] + 1
        node[2] = b = value["facets", f, 1] + 1
        node[3] = middle(a, b)
        length_ = sqrt((x[b, 1] - x[a, 1])^2 + (x[b, 2] - x[a, 2])^2)
        for (a = 1; a <= 3; a++) for (d = 1; d <= 2; d++)
            if (t[d] != 0) printf "%d,%d,%.9g\n", node[a], d, (a == 3 ? 4 : 1) / 6 * length_ * t[d]
    }
}

# The pair of the surface of group FACETS of contact k and the surface MASTER_.
function print_pair(k,    name, set, f) {
    name = toupper(label[k])
    set = name_index("facets.set", scene_value[k, "facets"])
    print "*SURFACE,NAME=SLAVE_" name ",TYPE=ELEMENT"
    for (f = 0; f < rows["facets"]; f++)
        if (value["facets.set", f, 0] == set)
            print side_of[face_key(value["facets", f, 0] + 1, value["facets", f, 1] + 1, value["facets", f, 2] + 1)]
    print "*SURFACE INTERACTION,NAME=CONTACT_" name
    print "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR"
    print "1.E8"
    print "*CONTACT PAIR,INTERACTION=CONTACT_" name ",TYPE=SURFACE TO SURFACE"
    print "SLAVE_" name ",MASTER_" name
}

# The elements behind a rigid surface: stiff, though their nodes are all fixed.
function print_stiff(name) {
    print "*MATERIAL,NAME=STIFF_" name
    print "*ELASTIC"
    print "1.E6,0.3"
    print "*SOLID SECTION,ELSET=STRIP_" name ",MATERIAL=STIFF_" name
    print "*BOUNDARY"
    print "RIGID_" name ",1," dim
}
