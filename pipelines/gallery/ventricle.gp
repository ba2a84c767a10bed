# The wall at rest, full and contracted, and pressure over volume: gnuplot -e "data='FOLDER/ventricle'; out='FILE.png'" ventricle.gp
set terminal pngcairo size 1000,520 font "DejaVu Sans,11" background "white"
set output out
set multiplot
set tmargin at screen 0.9
set bmargin at screen 0.12
set lmargin at screen 0.08
set rmargin at screen 0.5
set size ratio -1
set xrange [-14:14]
set yrange [-24:7]
set xlabel "radius, mm"
set ylabel "height, mm"
set key at screen 0.5,0.95 right center horizontal
wall(frame) = data.".wall.".frame
plot for [s = 1:2] wall(0) using ((2 * s - 3) * $1):2 with lines lw 1.5 dt 2 lc rgb "#606060" title (s == 1 ? "at rest" : ""), \
     for [s = 1:2] wall(3) using ((2 * s - 3) * $1):2 with lines lw 2 lc rgb "#2874a6" title (s == 1 ? "full" : ""), \
     for [s = 1:2] wall(10) using ((2 * s - 3) * $1):2 with lines lw 2.5 lc rgb "#b5367a" title (s == 1 ? "contracted" : "")
set size noratio
set lmargin at screen 0.56
set rmargin at screen 0.97
set xrange [1.4:4.6]
set yrange [0:16]
set xlabel "volume of the chamber, ml"
set ylabel "pressure, kPa"
set grid
unset key
set label 1 "it fills" at 3.3,2.1 center
set label 2 "it contracts" at 3.3,8.6
plot data.".tsv" skip 1 using 4:2 with linespoints pt 7 ps 1 lw 2 lc rgb "#b5367a"
