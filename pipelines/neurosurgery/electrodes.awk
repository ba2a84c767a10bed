# Contacts of depth electrodes, mm: six from either side, 20 on each, 2.6 mm apart from 8 mm beside the midline: awk -f electrodes.awk

BEGIN {
    n = split("45,15 25,35 0,20 -15,50 -30,40 -55,15", place, " ")
    for (side = -1; side <= 1; side += 2) {
        for (i = 1; i <= n; i++) {
            split(place[i], at, ",")
            for (k = 0; k < 20; k++) print side * (8 + 2.6 * k), at[1], at[2] + 0.2 * k
        }
    }
}
