# A disc of radius 10 mm in the plane z = 0 as triangles, rows of nine numbers, mm; its border has n corners.
BEGIN {
    turn = 2 * atan2(0, -1) / n
    for (i = 0; i < n; i++)
        print 0, 0, 0, 10 * cos(i * turn), 10 * sin(i * turn), 0, 10 * cos((i + 1) * turn), 10 * sin((i + 1) * turn), 0
}
