# What is measured in the operating theatre: rows x y z ux uy uz, mm, of points spread over the exposed cortex, or over other facets, with noise in
# each component, and perhaps a column with its standard deviation:
# awk -f stream.awk -f random.awk -f measured.awk -v field=u.dat -v points=200 -v noise=0.5 [-v groups=NAME,...] [-v deviation=0.5]

BEGIN {
    read_stream(field, "")
    need_section("u", "is " field " a result of mtled?")
    need_section("facets.set", "tag -f exposed=...")
    n = split(attribute["facets.set", "names"], name, ",")
    m = split(groups == "" ? "exposed" : groups, wanted, ",")
    for (k = 1; k <= m; k++) {
        set = -1
        for (i = 1; i <= n; i++) if (name[i] == wanted[k]) set = i - 1
        if (set < 0) die(field ": no facets '" wanted[k] "'")
        for (f = 0; f < rows["facets"]; f++) if (value["facets.set", f, 0] == set) facet[count++] = f
    }
    if (count < points) points = count
    if (points == 0) die(field ": the groups are empty")
    print "# Exposed cortex: places before and displacements"
    print "# x_mm\ty_mm\tz_mm\tux_mm\tuy_mm\tuz_mm"
    for (i = 0; i < points; i++) {
        f = facet[int(i * count / points)]
        printf "%.3f\t%.3f\t%.3f", mean("nodes.x", f, 0), mean("nodes.x", f, 1), mean("nodes.x", f, 2)
        for (axis = 0; axis < 3; axis++) printf "\t%.3f", mean("u", f, axis) + noise * normal()
        print deviation == "" ? "" : "\t" deviation
    }
}

# The mean at the corners of a facet, mm.
function mean(section, f, axis,    corner, sum) {
    for (corner = 0; corner < 3; corner++) sum += value[section, value["facets", f, corner], axis]
    return 1e3 * sum / 3
}
