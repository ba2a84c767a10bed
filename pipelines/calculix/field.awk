# The result of CalculiX as a stream: awk -f pipelines/stream.awk -f field.awk -v mesh=STREAM -v results=FILE.dat > u.dat
#
# Takes the displacements printed at the end of the step, nodes 1..N being those of the mesh.

BEGIN {
    read_stream(mesh, "")
    n = rows["nodes.x"]
    while ((getline < results) > 0) {
        if (/^ displacements/) { time = $NF; delete seen }
        else if (NF == 4 && $1 <= n) { u[$1] = $2 + 0; v[$1] = $3 + 0; seen[$1] = 1 }
    }
    for (i = 1; i <= n; i++) if (!(i in seen)) die(results ": no displacement of node " i)
    if (time + 0 != 1) die(results ": the last result is at time " time ", not at the end of the step")

    print "# mts 1"
    printf "# nodes.x f8 %d 2 enc=text unit=m cols=x,y\n", n
    for (i = 0; i < n; i++) print value["nodes.x", i, 0], value["nodes.x", i, 1]
    printf "\n\n# u f8 %d 2 enc=text unit=m cols=x,y\n", n
    for (i = 1; i <= n; i++) printf "%.9g %.9g\n", u[i], v[i]
    print "\n\n# end 2"
}
