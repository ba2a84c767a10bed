# The mean errors of convergence.tsv over the mean spacing, a panel for each case: gnuplot -e "data=...; cases=...; out=..."
set terminal pngcairo size 1500,900 font "DejaVu Sans,11"
set output out
set datafile separator "\t"
set logscale xy
set format y "%g"
set xlabel "nodes to the power -1/2"
set ylabel "mean error, mm"
set key left top samplen 2
set grid
set multiplot layout 2,3
do for [body in cases] {
    set title body noenhanced
    plot for [s in "mls1 mmls default mixed calculix"] data \
        using (strcol(1) eq body && strcol(2) eq s ? $4 ** -0.5 : NaN):5 with linespoints pt 7 ps 0.8 lw 2 title s
}
unset multiplot
