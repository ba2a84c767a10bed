# A table of points and displacements (x y ux uy, m) as a text stream: awk -f reference.awk TABLE > FILE

!/^#/ {
    n++
    x[n] = $1 " " $2
    u[n] = $3 " " $4
}

END {
    if (n == 0) {
        print "reference.awk: no rows" > "/dev/stderr"
        exit 2
    }
    print "# mts 1"
    printf "# nodes.x f8 %d 2 enc=text unit=m cols=x,y\n", n
    for (i = 1; i <= n; i++) print x[i]
    printf "\n\n# u f8 %d 2 enc=text unit=m cols=x,y\n", n
    for (i = 1; i <= n; i++) print u[i]
    print "\n\n# end 2"
}
