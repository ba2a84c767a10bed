# Mean errors of refinement.tsv over the nodes, true and estimated, a panel for each case: gnuplot -e "data=...; cases=...; out=..."
set terminal pngcairo size 420 * words(cases), 460 font "DejaVu Sans,12"
set output out
set datafile separator "\t"
set logscale xy
set format "%g"
set xlabel "nodes"
set ylabel "mean error, mm"
set grid
set multiplot layout 1, words(cases)
do for [body in cases] {
    set title body noenhanced
    if (body eq word(cases, words(cases))) { set key right top Left reverse samplen 2 } else { unset key }
    plot for [kind in "even graded"] data \
            using (strcol(1) eq body && strcol(2) eq kind ? $3 : NaN):7 with linespoints pt 7 ps 0.9 lw 2 \
            lc rgb (kind eq "even" ? "#2874a6" : "#b5367a") title kind, \
        for [kind in "even graded"] data \
            using (strcol(1) eq body && strcol(2) eq kind ? $3 : NaN):6 with linespoints pt 6 ps 0.7 dt 2 \
            lc rgb (kind eq "even" ? "#2874a6" : "#b5367a") title kind.", estimated"
}
unset multiplot
