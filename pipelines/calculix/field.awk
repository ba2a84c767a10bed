# The result of CalculiX as a stream: awk -f pipelines/stream.awk -f field.awk -v mesh=STREAM -v results=FILE.dat > u.dat
#
# Takes the displacements printed at the end of the step, nodes 1..N being those of the mesh, and the total forces on the
# prescribed nodes of each displacement of the scene.

BEGIN {
    read_stream(mesh, "")
    n = rows["nodes.x"]
    dim = cols["nodes.x"]
    while ((getline line < results) > 0) {
        count = split(line, field)
        if (line ~ /^ displacements/) { time = field[count]; delete u; delete total }
        else if (line ~ /^ total force/) { total_of = total_name(line) }
        else if (total_of != "") {
            if (count == 3) { total[total_of] = join(field, 0); total_of = "" }
        } else if (count == 4 && field[1] <= n) u[field[1]] = join(field, 1)
    }
    for (i = 1; i <= n; i++) if (!(i in u)) die(results ": no displacement of node " i)
    if (time + 0 != 1) die(results ": the last result is at time " time ", not at the end of the step")

    axes = dim == 2 ? "x,y" : "x,y,z"
    print "# mts 1"
    printf "# nodes.x f8 %d %d enc=text unit=m cols=%s\n", n, dim, axes
    for (i = 0; i < n; i++) print value["nodes.x", i, 0], value["nodes.x", i, 1] (dim == 2 ? "" : " " value["nodes.x", i, 2])
    printf "\n\n# reactions f8 %d %d enc=text unit=%s rows=%s\n", total_count, dim, dim == 2 ? "N/m" : "N", total_names
    for (i = 1; i <= total_count; i++) print total[total_order[i]]
    printf "\n\n# u f8 %d %d enc=text unit=m cols=%s\n", n, dim, axes
    for (i = 1; i <= n; i++) print u[i]
    print "\n\n# end 3"
}

# The dim numbers behind the first `skip` ones.
function join(field, skip,    d, text) {
    for (d = 1; d <= dim; d++) text = text (d > 1 ? " " : "") sprintf("%.9g", field[skip + d])
    return text
}

# The name in "total force (fx,fy,fz) for set MOVED_NAME and time ...".
function total_name(line,    name) {
    name = line
    sub(/.* for set MOVED_/, "", name)
    sub(/ .*/, "", name)
    name = tolower(name)
    if (!(name in known)) {
        known[name] = 1
        total_order[++total_count] = name
        total_names = total_names (total_count > 1 ? "," : "") name
    }
    return name
}
