# The errors of convergence.tsv of make brain2d-convergence: gnuplot -e "data=...; out=..."
set terminal pngcairo size 700,520 font "DejaVu Sans,11"
set output out
set logscale xy
set format y "%g"
set xlabel "size of the triangles inside, mm"
set ylabel "mean error, mm"
set key right bottom
set grid
set xrange [2.2:18]
set yrange [0.004:0.12]
set xtics (2.6, 3.65, 5.2, 7.3, 10.3, 14.6)
set ytics (0.005, 0.007, 0.01, 0.015, 0.02, 0.03, 0.05, 0.07, 0.1)
range(list, i) = real(system(sprintf("echo %s | cut -d - -f %d", list, i)))
of(kind) = sprintf("< awk -F '\\t' 'NR > 1 && $1 == \"%s\"' '%s'", kind, data)
set datafile separator tab
plot for [i = 1:2] of(word("even fine", i)) using 2:5:(range(strcol(4), 1)):(range(strcol(4), 2)) with yerrorbars pt 7 lc i notitle, \
    for [i = 1:2] of(word("even fine", i)) using 2:5 with lines lw 2 lc i \
        title i == 1 ? "even triangles: median of seven, least to largest" : "eight times finer at the ends of the craniotomy", \
    for [i = 1:2] of(word("even fine", i)) using 2:7 with lines dt 2 lc i notitle, \
    NaN with lines dt 2 lc "black" title "against the reference on an even mesh"
