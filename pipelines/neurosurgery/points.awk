# Rows x y z ux uy uz, mm, as a stream of points with u: awk -f points.awk measured.tsv | interp -f u -p PLACES ...

BEGIN { n = 0 }
/^#/ { next }
{
    x[n] = sprintf("%.9g %.9g %.9g", $1 / 1e3, $2 / 1e3, $3 / 1e3)
    u[n++] = sprintf("%.9g %.9g %.9g", $4 / 1e3, $5 / 1e3, $6 / 1e3)
}

END {
    print "# mts 1"
    section("nodes.x", "cols=x,y,z", x)
    section("u", "cols=x,y,z", u)
    print "# end 2"
}

function section(name, columns, rows,    i) {
    print "# " name " f8 " n " 3 enc=text unit=m " columns
    for (i = 0; i < n; i++) print rows[i]
    printf "\n\n"
}
