# Scans with the contours of the ventricles, and differences from the true one: gnuplot -e "folder='FOLDER'; out='FILE.png'" slices.gp

set terminal pngcairo size 1500,1240 font "DejaVu Sans,15" background "white"
set output out
data = folder."/slices.plot"
contour(name) = folder."/".name.".contour"
stats data using 3 nooutput
most = STATS_max

set size ratio -1
set xrange [-80:80]
set yrange [-110:80]
unset tics
unset border
unset colorbox
set key below samplen 2 maxrows 1
set palette gray
set cbrange [0:0.7 * most]
red = "#ff5030"
blue = "#30a0ff"

set multiplot layout 2,3 margins 0.01,0.99,0.05,0.95 spacing 0.02,0.09
set title "before"
plot data using 1:2:3 with image notitle, contour("before") using (1e3 * $1):(1e3 * $2) with lines lw 2 lc rgb blue title "ventricles"
set title "predicted"
plot data using 1:2:4 with image notitle, contour("true") using (1e3 * $1):(1e3 * $2) with lines lw 2 lc rgb "#60e060" title "true", \
     contour("predicted") using (1e3 * $1):(1e3 * $2) with lines lw 2 lc rgb red title "predicted"
set title "true"
plot data using 1:2:5 with image notitle, contour("before") using (1e3 * $1):(1e3 * $2) with lines lw 2 lc rgb blue title "before", \
     contour("true") using (1e3 * $1):(1e3 * $2) with lines lw 2 lc rgb "#60e060" title "true"
set cbrange [0:0.5 * most]
set palette negative gray
set title "|before - true|"
plot data using 1:2:(abs($3 - $5)) with image notitle
set title "|predicted - true|"
plot data using 1:2:(abs($4 - $5)) with image notitle
unset multiplot
