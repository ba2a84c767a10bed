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
set yrange [0.01:0.12]
set xtics (2.6, 3.65, 5.2, 7.3, 10.3, 14.6)
set ytics (0.01, 0.015, 0.02, 0.03, 0.05, 0.07, 0.1)
part(list, i) = real(system(sprintf("echo %s | cut -d / -f %d", list, i)))
plot for [i = 1:3] data every ::1 using 1:(part(strcol(3), i)) with points pt 6 lc 1 title i == 1 ? "three meshes" : "", \
    data every ::1 using 1:4 with linespoints pt 7 lw 2 lc 1 title "median", \
    data every ::1 using 1:6 with lines dt 2 lc 2 title "median, against the reference on an even mesh"
