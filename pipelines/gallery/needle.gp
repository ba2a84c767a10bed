# Force over depth, and the tissue: gnuplot -e "data='needle.tsv'; tissue='needle.rows'; out='FILE.png'" needle.gp
set terminal pngcairo size 1000,430 font "DejaVu Sans,11" background "white"
set output out
set multiplot layout 1, 2
set xlabel "depth of the tip, mm"
set ylabel "force on the needle, N/m"
set key top left Left reverse
set grid
set xrange [0:52]
plot data skip 1 using 1:2 with linespoints pt 7 ps 0.6 lc rgb "#b5367a" title "mu = 0.3", \
     data skip 1 using 1:3 with linespoints pt 7 ps 0.6 lc rgb "#2874a6" title "without friction"
unset grid; unset key
set size ratio -1
set xrange [-12:72]; set yrange [-32:32]
set xlabel "x, mm"; set ylabel "y, mm"; set cblabel "dragged along, mm"
set palette defined (0 "#440154", 1 "#3b528b", 2 "#21918c", 3 "#5ec962", 4 "#fde725")
set object polygon from -12,1 to 39,1 to 49,0 to 39,-1 to -12,-1 to -12,1 front fillstyle solid fillcolor rgb "#808080"
plot tissue with filledcurves closed lc palette
