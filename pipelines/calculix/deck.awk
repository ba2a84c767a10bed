# The input deck of a scene for CalculiX: awk -f pipelines/stream.awk -f deck.awk -v scene=FILE -v mesh=STREAM > FILE.inp
#
# STREAM (text) holds what `nodes` writes. Its triangles become quadratic plane strain elements (CPE6) with the mid-nodes
# on the straight edges, so that nodes 1..N are those of the stream and the geometry is the same. Understood of a scene:
# neo-Hookean materials of one region each, displacements by table on one group of facets, contact of one group with
# a rigid curve in one piece; anything else in it is an error. SI units, per metre of thickness.

BEGIN {
    read_scene(scene)
    read_stream(mesh, "")
    need_section("nodes.x", "run nodes")
    need_section("facets", "run nodes")
    if (scene_value["scene", "dim"] != 2 || cols["cells"] != 3) die(scene ": only scenes in 2D")

    print "** " scene ", plane strain, SI units"
    print_nodes()
    print_elements()
    for (k = 1; k <= section_count; k++) if (kind[k] == "material") print_material(k)
    else if (kind[k] !~ /^(displacement|contact|solver|output)$/) die(scene ": section [" kind[k] "] is not understood")
    for (k = 1; k <= section_count; k++) if (kind[k] == "displacement") collect_displacement(k)
    for (k = 1; k <= section_count; k++) if (kind[k] == "contact") print_contact(k)
    print "*NSET,NSET=CORNERS,GENERATE"
    print "1," rows["nodes.x"] ",1"
    print "*STEP,NLGEOM,INC=2000"
    print "*STATIC"
    print "0.05,1.,1.E-7,0.1"
    print "*BOUNDARY"
    for (k = 1; k <= prescribed_count; k++) print prescribed[k]
    print "*NODE PRINT,NSET=CORNERS"
    print "U"
    print "*END STEP"
}

# ---- scene -----------------------------------------------------------------------------------------------------------

# Sections k = 1..section_count: kind[k], label[k], scene_value[k, KEY]; [scene] itself under scene_value["scene", KEY].
function read_scene(file,    line, equals, where, words) {
    folder = file
    if (!sub(/\/[^\/]*$/, "/", folder)) folder = ""
    while ((getline line < file) > 0) {
        sub(/(^|[ \t])[#;].*/, "", line)
        if (line ~ /^\[/) {
            gsub(/[][]/, "", line)
            split(line, words)
            if (words[1] == "scene") { where = "scene"; continue }
            where = ++section_count
            kind[where] = words[1]
            label[where] = words[2]
        } else if ((equals = index(line, "=")) > 0) {
            scene_value[where, trim(substr(line, 1, equals - 1))] = trim(substr(line, equals + 1))
        }
    }
    close(file)
    if (section_count == 0) die(file ": no scene")
}

function trim(text) {
    gsub(/^[ \t]+|[ \t]+$/, "", text)
    return text
}

function metres(unit) {
    if (unit == "m") return 1
    if (unit == "cm") return 1e-2
    if (unit == "mm") return 1e-3
    if (unit == "um") return 1e-6
    die("unknown unit " unit)
}

# Rows of a table of the scene: table[row, column], in metres, rows from 1; returns their number. Blank lines and
# comments are skipped.
function read_table(k, key, width,    file, line, field, count, n, i) {
    file = folder scene_value[k, key]
    while ((getline line < file) > 0) {
        sub(/#.*/, "", line)
        count = split(line, field)
        if (count == 0) continue
        n++
        if (count != width) die(file ": not rows of " width " numbers")
        for (i = 1; i <= count; i++) table[n, i] = field[i] * metres(scene_value[k, "unit"])
    }
    close(file)
    if (n < 2) die(file ": no table")
    return n
}

# The number, from 0, of NAME among the names= of a section.
function name_index(section, name,    names, count, i) {
    count = split(attribute[section, "names"], names, ",")
    for (i = 1; i <= count; i++) if (names[i] == name) return i - 1
    die("no group " name " in section " section)
}

# ---- mesh ------------------------------------------------------------------------------------------------------------

# The number of the mid-node of edge a-b (deck numbers, from 1).
function middle(a, b,    low, high) {
    low = a < b ? a : b
    high = a < b ? b : a
    if (!((low, high) in mid)) {
        mid[low, high] = ++node_count
        x[node_count] = (x[a] + x[b]) / 2
        y[node_count] = (y[a] + y[b]) / 2
    }
    return mid[low, high]
}

function print_nodes(    i, c, e, a, b) {
    node_count = rows["nodes.x"]
    for (i = 1; i <= node_count; i++) {
        x[i] = value["nodes.x", i - 1, 0] + 0
        y[i] = value["nodes.x", i - 1, 1] + 0
    }
    for (c = 0; c < rows["cells"]; c++)
        for (e = 0; e < 3; e++) {
            a = value["cells", c, e] + 1
            b = value["cells", c, (e + 1) % 3] + 1
            middle(a, b)
            side_of[a, b] = (c + 1) ",S" (e + 1)
        }
    print "*NODE,NSET=BODY"
    for (i = 1; i <= node_count; i++) printf "%d,%.9g,%.9g\n", i, x[i], y[i]
}

function print_elements(    names, count, g, c, n1, n2, n3) {
    count = split(attribute["cells.region", "names"], names, ",")
    for (g = 1; g <= count; g++) {
        print "*ELEMENT,TYPE=CPE6,ELSET=" toupper(names[g])
        for (c = 0; c < rows["cells"]; c++) {
            if (value["cells.region", c, 0] != g - 1) continue
            n1 = value["cells", c, 0] + 1
            n2 = value["cells", c, 1] + 1
            n3 = value["cells", c, 2] + 1
            printf "%d,%d,%d,%d,%d,%d,%d\n", c + 1, n1, n2, n3, middle(n1, n2), middle(n2, n3), middle(n3, n1)
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
function collect_displacement(k,    n, set, f, a, b) {
    n = read_table(k, "table", 4)
    set = name_index("facets.set", scene_value[k, "facets"])
    for (f = 0; f < rows["facets"]; f++) {
        if (value["facets.set", f, 0] != set) continue
        a = value["facets", f, 0] + 1
        b = value["facets", f, 1] + 1
        prescribe(a, n)
        prescribe(b, n)
        prescribe(middle(a, b), n)
    }
}

# Prescribe node i by the table of n points along a curve: linear between the ends of the nearest segment.
function prescribe(i, n,    s, best, distance2, t, dx, dy, ux, uy) {
    if (i in is_prescribed) return
    is_prescribed[i] = 1
    best = -1
    for (s = 1; s < n; s++) {
        dx = table[s + 1, 1] - table[s, 1]
        dy = table[s + 1, 2] - table[s, 2]
        t = ((x[i] - table[s, 1]) * dx + (y[i] - table[s, 2]) * dy) / (dx^2 + dy^2)
        t = t < 0 ? 0 : t > 1 ? 1 : t
        distance2 = (x[i] - table[s, 1] - t * dx)^2 + (y[i] - table[s, 2] - t * dy)^2
        if (best >= 0 && distance2 >= best) continue
        best = distance2
        ux = table[s, 3] + t * (table[s + 1, 3] - table[s, 3])
        uy = table[s, 4] + t * (table[s + 1, 4] - table[s, 4])
    }
    prescribed[++prescribed_count] = sprintf("%d,1,1,%.9g", i, ux)
    prescribed[++prescribed_count] = sprintf("%d,2,2,%.9g", i, uy)
}

# The rigid curve as a strip of quadrilaterals 6 mm wide, all its nodes fixed, behind the face that the body touches.
function print_contact(k,    n, i, set, f, dx, dy, length_, sign, first_node, first_element, next_node, name, thickness) {
    n = read_table(k, "rigid", 2)
    thickness = 6e-3
    sign = scene_value[k, "side"] == "left" ? 1 : -1 # the strip lies on the other side of the curve
    name = toupper(label[k])
    first_node = node_count
    print "*NODE,NSET=RIGID_" name
    for (i = 1; i <= n; i++) {
        dx = table[i < n ? i + 1 : i, 1] - table[i > 1 ? i - 1 : i, 1]
        dy = table[i < n ? i + 1 : i, 2] - table[i > 1 ? i - 1 : i, 2]
        length_ = sqrt(dx^2 + dy^2)
        printf "%d,%.9g,%.9g\n", ++node_count, table[i, 1], table[i, 2]
        printf "%d,%.9g,%.9g\n", ++node_count, table[i, 1] + sign * thickness * dy / length_,
            table[i, 2] - sign * thickness * dx / length_
    }
    first_element = element_count + 1
    print "*ELEMENT,TYPE=CPE4,ELSET=STRIP_" name
    for (i = 1; i < n; i++) {
        f = first_node + 2 * i - 1
        next_node = f + 2
        if (sign > 0) printf "%d,%d,%d,%d,%d\n", ++element_count, f, f + 1, next_node + 1, next_node
        else printf "%d,%d,%d,%d,%d\n", ++element_count, next_node, next_node + 1, f + 1, f
    }
    print "*MATERIAL,NAME=STIFF_" name
    print "*ELASTIC"
    print "1.E6,0.3"
    print "*SOLID SECTION,ELSET=STRIP_" name ",MATERIAL=STIFF_" name
    print "*BOUNDARY"
    print "RIGID_" name ",1,2"
    print "*SURFACE,NAME=MASTER_" name ",TYPE=ELEMENT"
    for (i = first_element; i <= element_count; i++) print i ",S4"

    set = name_index("facets.set", scene_value[k, "facets"])
    print "*SURFACE,NAME=SLAVE_" name ",TYPE=ELEMENT"
    for (f = 0; f < rows["facets"]; f++)
        if (value["facets.set", f, 0] == set) print side_of[value["facets", f, 0] + 1, value["facets", f, 1] + 1]
    print "*SURFACE INTERACTION,NAME=CONTACT_" name
    print "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR"
    print "1.E8"
    print "*CONTACT PAIR,INTERACTION=CONTACT_" name ",TYPE=SURFACE TO SURFACE"
    print "SLAVE_" name ",MASTER_" name
}
