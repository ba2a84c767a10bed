# The mean errors of convergence.tsv over the mean spacing, a panel for each case: gnuplot -e "data=...; cases=...; out=..."
# Panels stand three in a row, and the legend in the last one; a scheme that the table lacks is not in it.
columns = words(cases) < 3 ? words(cases) + 1 : 3
lines = (words(cases) + columns) / columns
set terminal pngcairo size 420 * columns, 400 * lines + 60 font "DejaVu Sans,12"
set output out
set datafile separator "\t"
name(s) = s eq "mls1" ? "linear MLS (paper)" : s eq "mmls" ? "MMLS (paper)" : s eq "default" ? "default" : \
    s eq "mixed" ? "mixed elements" : "CalculiX"
colour(s) = s eq "default" ? "#b5367a" : s eq "mixed" ? "#2874a6" : s eq "calculix" ? "#e0a030" : s eq "mls1" ? "#909090" : "#404040"
found = " ".system(sprintf("cut -f 2 '%s' | sort -u | tr '\\n' ' '", data))
there = ""
do for [s in "mls1 mmls default mixed calculix"] {
    if (strstrt(found, " ".s." ") > 0) { there = there." ".s }
}
set logscale xy
set format "%g"
set xlabel "nodes to the power -1/2"
set ylabel "mean error, mm"
unset key
set grid
set multiplot layout lines, columns
do for [body in cases] {
    set title body noenhanced
    plot for [s in there] data \
        using (strcol(1) eq body && strcol(2) eq s ? $4 ** -0.5 : NaN):5 with linespoints pt 7 ps 0.9 lw 2 lc rgb colour(s) title name(s)
}
set key center samplen 3 spacing 1.5
unset border
unset tics
unset title
unset xlabel
unset ylabel
unset logscale
plot [0:1] [0:1] for [s in there] NaN with linespoints pt 7 ps 0.9 lw 2 lc rgb colour(s) title name(s)
unset multiplot
