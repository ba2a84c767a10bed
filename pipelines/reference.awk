# A table of points and displacements (rows x.. u.., m) as a text stream: awk -f reference.awk [-v push=P] TABLE > FILE
#
# With P (m) the table is of the part x.. >= 0 of a body of .1 m with the origin in its middle, symmetric to the planes through it
# and pressed by P/2 on both ends of its last axis. What comes out is the whole body, from 0 to .1 m, held at the lower end
# and pressed by P at the upper one.

/^#/ { next }
{
    dim = NF / 2
    for (image = 0; image < (push == "" ? 1 : 2 ^ dim); image++) {
        place = move = ""
        for (d = 1; d <= dim; d++) {
            sign = int(image / 2 ^ (d - 1)) % 2 ? -1 : 1
            if (sign < 0 && $d < 1e-9) break
            place = place " " (push == "" ? $d : sprintf("%.9g", 0.05 + sign * $d))
            move = move " " (push == "" ? $(d + dim) : sprintf("%.9g", sign * $(d + dim) - (d == dim ? push / 2 : 0)))
        }
        if (d <= dim) continue
        n++
        x[n] = substr(place, 2)
        u[n] = substr(move, 2)
    }
}

END {
    if (n == 0) {
        print "reference.awk: no rows" > "/dev/stderr"
        exit 2
    }
    axes = dim == 2 ? "x,y" : "x,y,z"
    print "# mts 1"
    printf "# nodes.x f8 %d %d enc=text unit=m cols=%s\n", n, dim, axes
    for (i = 1; i <= n; i++) print x[i]
    printf "\n\n# u f8 %d %d enc=text unit=m cols=%s\n", n, dim, axes
    for (i = 1; i <= n; i++) print u[i]
    print "\n\n# end 2"
}
