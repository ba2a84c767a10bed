# The displacement of a thick cylinder, radii 1 and 2 m, E 3000 Pa, under .001 Pa from within, in plane strain (Lame; the load is that
# small for the linear theory to be exact to 1e-6), at places over a quarter of its section, as a text stream: awk -v nu=0.3 -f cylinder.awk

BEGIN {
    n = 0
    for (i = 0; i <= 64; i++) {
        for (k = 0; k <= 96; k++) {
            r = 1 + i / 64
            angle = k / 96 * atan2(1, 0)
            u = (1 + nu) / 3000 * 0.001 / 3 * ((1 - 2 * nu) * r + 4 / r)
            place[n] = sprintf("%.12g %.12g", r * cos(angle), r * sin(angle))
            move[n++] = sprintf("%.12g %.12g", u * cos(angle), u * sin(angle))
        }
    }
    print "# mts 1"
    printf "# nodes.x f8 %d 2 enc=text unit=m cols=x,y\n", n
    for (i = 0; i < n; i++) print place[i]
    printf "\n\n# u f8 %d 2 enc=text unit=m cols=x,y\n", n
    for (i = 0; i < n; i++) print move[i]
    print "\n\n# end 2"
}
