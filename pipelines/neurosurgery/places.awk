# Random places in a box, mm: awk -f random.awk -f places.awk -v count=N -v low=X,Y,Z -v high=X,Y,Z

BEGIN {
    split(low, from, ",")
    split(high, to, ",")
    for (i = 0; i < count; i++) {
        for (axis = 1; axis <= 3; axis++) printf "%.2f%s", from[axis] + (to[axis] - from[axis]) * uniform(), axis < 3 ? "\t" : "\n"
    }
}
