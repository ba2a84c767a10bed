# Scans with the contours of the ventricles, and how far they are from the true one: gnuplot -e "folder='FOLDER'; out='FILE.png';
# prediction='NAME'; seen='from ...'" slices.gp

set terminal pngcairo size 1500,1300 font "DejaVu Sans,16" background "white"
set output out
data = folder."/slices.plot"
contour(name) = folder."/".name.".contour"
stats data using 3 nooutput
most = STATS_max

set size ratio -1
set xrange [-78:78]
set yrange [-110:78]
unset tics
unset border
unset colorbox
set key at graph 0.5,-0.01 center top samplen 2 maxrows 1
set palette gray
set cbrange [0:most]
before = "#30a0ff"
predicted = "#ff5030"
true = "#60e060"

set multiplot
place(column, row) = sprintf("set lmargin at screen %g; set rmargin at screen %g; set bmargin at screen %g; set tmargin at screen %g", \
    0.01 + 0.325 * column, 0.325 * (column + 1), 0.56 - 0.5 * row, 0.96 - 0.5 * row)

eval(place(0, 0))
set title "before"
plot data using 1:2:3 with image notitle, contour("before") using (1e3 * $1):(1e3 * $2) with lines lw 2.5 lc rgb before title "ventricles"
eval(place(1, 0))
set title "predicted ".seen
plot data using 1:2:4 with image notitle, contour("true") using (1e3 * $1):(1e3 * $2) with lines lw 2.5 lc rgb true title "true", \
     contour(prediction) using (1e3 * $1):(1e3 * $2) with lines lw 2.5 lc rgb predicted title "predicted"
eval(place(2, 0))
set title "true"
plot data using 1:2:5 with image notitle, contour("before") using (1e3 * $1):(1e3 * $2) with lines lw 2.5 lc rgb before title "before", \
     contour("true") using (1e3 * $1):(1e3 * $2) with lines lw 2.5 lc rgb true title "true"
set cbrange [0:0.5 * most]
set palette negative gray
eval(place(0, 1))
set title "|predicted - true|"
plot data using 1:2:(abs($4 - $5)) with image notitle

set palette positive defined (0 "#fcfdbf", 1 "#fec488", 2 "#fb8761", 3 "#e55064", 4 "#b5367a", 5 "#812581", 6 "#4f127b")
stats folder."/distance.plot" using 3 nooutput
set cbrange [0:STATS_max]
set cbtics 1
eval(place(1, 1))
set title "distance from the true place, mm: no load"
plot folder."/distance.plot" using 1:2:3 with points pt 5 ps 1.3 lc palette notitle
eval(place(2, 1))
set title "with the weight that is found"
set colorbox user horizontal origin 0.36,0.035 size 0.6,0.015
plot folder."/distance.plot" using 1:2:4 with points pt 5 ps 1.3 lc palette notitle
unset multiplot
