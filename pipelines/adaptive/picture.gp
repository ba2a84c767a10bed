# Mean errors of refinement.tsv over the nodes, true and estimated, a panel for each case: gnuplot -e "data=...; cases=...; out=..."
# Panels stand four in a row, and the legend in the last one.
columns = words(cases) < 4 ? words(cases) + 1 : 4
lines = (words(cases) + columns) / columns
set terminal pngcairo size 400 * columns, 400 * lines font "DejaVu Sans,12"
set output out
set datafile separator "\t"
set logscale xy
set format "%g"
set xlabel "nodes"
set ylabel "mean error, mm"
set grid
unset key
colour(kind) = kind eq "even" ? "#2874a6" : "#b5367a"
set multiplot layout lines, columns
do for [body in cases] {
    set title body noenhanced
    plot for [kind in "even graded"] data \
            using (strcol(1) eq body && strcol(2) eq kind ? $3 : NaN):7 with linespoints pt 7 ps 0.9 lw 2 \
            lc rgb colour(kind), \
        for [kind in "even graded"] data \
            using (strcol(1) eq body && strcol(2) eq kind ? $3 : NaN):6 with linespoints pt 6 ps 0.7 dt 2 \
            lc rgb colour(kind)
}
set key center samplen 3 spacing 1.5
unset border
unset tics
unset title
unset xlabel
unset ylabel
unset logscale
plot [0:1] [0:1] for [kind in "even graded"] NaN with linespoints pt 7 ps 0.9 lw 2 lc rgb colour(kind) title kind, \
    for [kind in "even graded"] NaN with linespoints pt 6 ps 0.7 dt 2 lc rgb colour(kind) title kind.", estimated"
unset multiplot
