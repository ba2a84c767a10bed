# A scene and its mesh for solve2d.edp and solve3d.edp:
#
#     awk -f pipelines/stream.awk -f pipelines/scene.awk -f pipelines/table.awk -f problem.awk -v scene=FILE -v mesh=STREAM -v out=DIR
#
# STREAM (text) holds what `nodes` writes. Writes DIR/body.msh (2D, FreeFEM's own format) or DIR/body.mesh (3D), with the
# number of the group of a facet, from 1, as label and that of the region of a cell, from 1, as region; DIR/problem, which the
# programs read; and DIR/given, how many rows, and a row A B u.. for the nodes, A = B from 0, and the edges of the facets that a table displaces. Understood of
# a scene: neo-Hookean materials of one region each, displacements by components, by a table, or along the normal of a flat
# face across an axis, dead tractions, in 2D one contact with a rigid curve that stays, which goes to DIR/rigid; anything
# else in it is an error. SI units, in 2D per metre of thickness.

BEGIN {
    read_scene(scene)
    read_stream(mesh, "")
    need_section("nodes.x", "run nodes")
    need_section("facets", "run nodes")
    dim = cols["nodes.x"]
    if (scene_value["scene", "dim"] != dim || cols["cells"] != dim + 1)
        die(scene ": not a scene in the " dim " dimensions of " mesh)
    if (scene_value["scene", "analysis"] != "quasi-static") die(scene ": only quasi-static scenes")
    label_count = split(attribute["facets.set", "names"], label_name, ",")
    region_count = split(attribute["cells.region", "names"], region_name, ",")
    for (k = 1; k <= section_count; k++) if (kind[k] == "material") take_material(k)
    else if (kind[k] == "displacement") take_displacement(k)
    else if (kind[k] == "traction") take_traction(k)
    else if (kind[k] == "contact" && dim == 2) take_contact(k)
    else if (kind[k] !~ /^(solver|output)$/) die(scene ": section [" kind[k] "] is not understood")
    for (k = 1; k <= section_count; k++) if ((k, "table") in scene_value) give(k)
    print_given(out "/given")
    print_rigid(out "/rigid")
    print_mesh(out "/body." (dim == 2 ? "msh" : "mesh"))
    print_problem(out "/problem")
}

# W = mu/2 (J^(-2/3) I1 - 3) + kappa/2 (J - 1)^2.
function take_material(k,    E, nu, region) {
    if (scene_value[k, "model"] !~ /^(neo-hookean)?$/) die(scene ": only neo-Hookean materials")
    E = scene_value[k, "E"]
    nu = scene_value[k, "nu"]
    region = name_index("cells.region", scene_value[k, "region"]) + 1
    shear[region] = E / (2 * (1 + nu))
    bulk[region] = E / (3 * (1 - 2 * nu))
}

function take_displacement(k,    names, count, i, label, value_, d) {
    if ((k, "curve") in scene_value) die(scene ": only displacements without a curve")
    moved[++moved_count] = k
    count = split(scene_value[k, "facets"], names, /[ \t]*,[ \t]*/)
    for (i = 1; i <= count; i++) {
        label = name_index("facets.set", names[i]) + 1
        group[k] = group[k] " " label
        if ((k, "table") in scene_value) for (d = 1; d <= dim; d++) hold(label, d, 0)
        else if ((k, "normal") in scene_value) hold(label, axis_of(label), sign_of_axis * scene_value[k, "normal"])
        else if (split(scene_value[k, "components"], value_, /[ \t]*,[ \t]*/) != dim)
            die(scene ": only displacements by components, by a table, or along a normal")
        else for (d = 1; d <= dim; d++) if (value_[d] != "free") hold(label, d, value_[d])
    }
}

# What the table of displacement k gives at the nodes and in the middle of the edges of its facets.
function give(k,    n, labels, count, i, f, a, b, set) {
    n = read_table(k, "table", 2 * dim)
    count = split(scene_value[k, "facets"], labels, /[ \t]*,[ \t]*/)
    for (i = 1; i <= count; i++) {
        set = name_index("facets.set", labels[i])
        for (f = 0; f < rows["facets"]; f++) {
            if (value["facets.set", f, 0] != set) continue
            for (a = 0; a < dim; a++) for (b = 0; b <= a; b++) give_at(value["facets", f, a], value["facets", f, b], n)
        }
    }
}

# Between nodes a and b; the first table that reaches them counts, as in mtled.
function give_at(a, b, n,    d, u, line) {
    if ((a, b) in given) return
    given[a, b] = given[b, a] = 1
    for (d = 1; d <= dim; d++) x[0, d] = (value["nodes.x", a, d - 1] + value["nodes.x", b, d - 1]) / 2
    table_at(0, n, u)
    for (d = 1; d <= dim; d++) line = line sprintf(" %.17g", u[d])
    given_row[++given_count] = a " " b line
}

function print_given(file,    i) {
    print given_count + 0 > file
    for (i = 1; i <= given_count; i++) print given_row[i] > file
    close(file)
}

function hold(label, d, displacement) {
    if ((label, d) in held && held[label, d] != displacement) die(scene ": " label_name[label] " is moved in two ways")
    held[label, d] = displacement + 0
}

# The axis across which the face of a label lies; sign_of_axis tells on which side the body is not.
function axis_of(label,    f, d, axis, normal, sign) {
    axis = 0
    for (f = 0; f < rows["facets"]; f++) {
        if (value["facets.set", f, 0] != label - 1) continue
        facet_normal(f, normal)
        for (d = 1; d <= dim; d++) {
            if (normal[d] ^ 2 < 1 - 1e-9) continue
            sign = normal[d] > 0 ? 1 : -1
            if (axis != 0 && (axis != d || sign != sign_of_axis)) axis = -1
            else { axis = d; sign_of_axis = sign; continue }
        }
        if (axis <= 0 || normal[axis] ^ 2 < 1 - 1e-9) die(scene ": " label_name[label] " does not lie across an axis")
    }
    if (axis == 0) die(scene ": " label_name[label] " has no facets")
    return axis
}

# The outward unit normal of a facet; facets point outward.
function facet_normal(f, normal,    d, a, b, c, p, q, size) {
    a = value["facets", f, 0]; b = value["facets", f, 1]
    for (d = 0; d < dim; d++) p[d] = value["nodes.x", b, d] - value["nodes.x", a, d]
    if (dim == 2) {
        normal[1] = p[1]
        normal[2] = -p[0]
    } else {
        c = value["facets", f, 2]
        for (d = 0; d < 3; d++) q[d] = value["nodes.x", c, d] - value["nodes.x", a, d]
        for (d = 0; d < 3; d++) normal[d + 1] = p[(d + 1) % 3] * q[(d + 2) % 3] - p[(d + 2) % 3] * q[(d + 1) % 3]
    }
    for (d = 1; d <= dim; d++) size += normal[d] ^ 2
    for (d = 1; d <= dim; d++) normal[d] /= sqrt(size)
}

function take_traction(k,    names, count, i, d, value_, label) {
    if (split(scene_value[k, "components"], value_, /[ \t]*,[ \t]*/) != dim || (k, "curve") in scene_value)
        die(scene ": only tractions by components")
    count = split(scene_value[k, "facets"], names, /[ \t]*,[ \t]*/)
    for (i = 1; i <= count; i++) {
        label = name_index("facets.set", names[i]) + 1
        for (d = 1; d <= dim; d++) traction[label, d] += value_[d]
    }
}

# One rigid curve, the body on its left, and the labels that it may touch.
function take_contact(k,    n, i, j, names, count) {
    if (rigid_count || (k, "translation") in scene_value || (k, "angle") in scene_value)
        die(scene ": only one contact, with a curve that stays")
    n = read_table(k, "rigid", 2)
    for (i = 1; i <= n; i++) {
        j = scene_value[k, "side"] == "left" ? i : n + 1 - i
        rigid_row[i] = sprintf("%.17g %.17g", table[j, 1], table[j, 2])
    }
    rigid_count = n
    count = split(scene_value[k, "facets"], names, /[ \t]*,[ \t]*/)
    for (i = 1; i <= count; i++) touching[++touching_count] = name_index("facets.set", names[i]) + 1
}

function print_rigid(file,    i) {
    print touching_count + 0, rigid_count + 0 > file
    for (i = 1; i <= touching_count; i++) print touching[i] > file
    for (i = 1; i <= rigid_count; i++) print rigid_row[i] > file
    close(file)
}

function print_mesh(file,    i, d, c, line) {
    if (dim == 2) print rows["nodes.x"], rows["cells"], rows["facets"] > file
    else print "MeshVersionFormatted 2\nDimension 3\nVertices\n" rows["nodes.x"] > file
    for (i = 0; i < rows["nodes.x"]; i++) {
        line = ""
        for (d = 0; d < dim; d++) line = line value["nodes.x", i, d] " "
        print line 0 > file
    }
    if (dim == 3) print "Tetrahedra\n" rows["cells"] > file
    for (c = 0; c < rows["cells"]; c++) {
        line = ""
        for (i = 0; i <= dim; i++) line = line value["cells", c, i] + 1 " "
        print line value["cells.region", c, 0] + 1 > file
    }
    if (dim == 3) print "Triangles\n" rows["facets"] > file
    for (c = 0; c < rows["facets"]; c++) {
        line = ""
        for (i = 0; i < dim; i++) line = line value["facets", c, i] + 1 " "
        print line value["facets.set", c, 0] + 1 > file
    }
    if (dim == 3) print "End" > file
    close(file)
}

# Regions: shear and bulk modulus; labels: for each component whether it is held, where it goes, and the traction;
# displacements: how many labels, the labels, the name.
function print_problem(file,    i, d, k, line, none) {
    print region_count, label_count, moved_count > file
    for (i = 1; i <= region_count; i++) {
        if (!(i in shear)) die(scene ": no material for " region_name[i])
        printf "%.17g %.17g\n", shear[i], bulk[i] > file
    }
    for (i = 1; i <= label_count; i++) {
        line = ""
        for (d = 1; d <= dim; d++) line = line sprintf("%d %.17g %.17g ", (i, d) in held, held[i, d], traction[i, d])
        print line > file
    }
    for (k = 1; k <= moved_count; k++) {
        i = split(group[moved[k]], none, " ")
        print i group[moved[k]] " " label[moved[k]] > file
    }
    close(file)
}
