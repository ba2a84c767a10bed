# The errors of speed-error.tsv over the time, a panel for each case: gnuplot -e "data=...; cases=...; out=..."
# Panels stand four in a row; a scheme that the table lacks is not in the legend.
columns = words(cases) < 4 ? words(cases) : 4
lines = (words(cases) + columns - 1) / columns
set terminal pngcairo size 420 * columns, 400 * lines + 60 font "DejaVu Sans,12"
set output out
set datafile separator "\t"
name(s) = s eq "mls1" ? "linear MLS (paper)" : s eq "mmls" ? "MMLS (paper)" : s eq "default" ? "default" : \
    s eq "mixed" ? "mixed elements (FreeFEM)" : s eq "dolfinx" ? "mixed elements (dolfinx)" : "CalculiX"
colour(s) = s eq "default" ? "#b5367a" : s eq "mixed" ? "#2874a6" : s eq "dolfinx" ? "#2e8b57" : s eq "calculix" ? "#e0a030" : s eq "mls1" ? "#909090" : "#404040"
found = " ".system(sprintf("cut -f 2 '%s' | sort -u | tr '\\n' ' '", data))
there = ""
do for [s in "mls1 mmls default mixed dolfinx calculix"] {
    if (strstrt(found, " ".s." ") > 0) { there = there." ".s }
}
set logscale xy
set format "%g"
set xlabel "processor seconds, one thread"
set ylabel "mean error, % of the largest displacement"
unset key
set grid
set multiplot layout lines, columns
do for [body in cases] {
    set title body noenhanced
    if (body eq word(cases, words(cases))) { set key left top Left reverse samplen 1 }
    plot for [s in there] data \
        using (strcol(1) eq body && strcol(2) eq s ? $7 : NaN):8 with linespoints pt 7 ps 0.9 lw 2 lc rgb colour(s) title name(s)
}
unset multiplot
