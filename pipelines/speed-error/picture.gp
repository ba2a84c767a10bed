# The errors of speed-error.tsv over the time, a panel for each case: gnuplot -e "data=...; cases=...; out=..."
set terminal pngcairo size 1600,800 font "DejaVu Sans,11"
set output out
set datafile separator "\t"
set logscale xy
set format y "%g"
set xlabel "processor seconds, one thread"
set ylabel "error, %"
set key right top samplen 2
set grid
set multiplot layout 2,4
do for [body in cases] {
    set title body noenhanced
    plot for [s in "mls1 mmls default mixed calculix"] data \
        using (strcol(1) eq body && strcol(2) eq s ? $7 : NaN):8 with linespoints pt 7 ps 0.8 lw 2 title s
}
unset multiplot
