# A body in 3D, shaded, whole and cut: gnuplot -e "whole='FILE'; part='FILE'; most=MM; title='TEXT'; second='TEXT'; out='FILE.png'" body3d.gp
# whole and part are what body3d.awk writes, without and with a cut; `most` as there.

set terminal pngcairo size 1500,720 font "DejaVu Sans,14" background "white"
set output out
set palette defined (0 "#fcfdbf", 1 "#fec488", 2 "#fb8761", 3 "#e55064", 4 "#b5367a", 5 "#812581", 6 "#4f127b", 7 "#1c1044")
set cbrange [0:most]
set cblabel "displacement, mm (green: more)" offset 1,0
set size ratio -1
unset border
unset tics
unset key
set cbtics
set multiplot
set bmargin at screen 0.03
set tmargin at screen 0.90
stats whole index 0 using 1:2 nooutput
set yrange [STATS_min_y - 20 : STATS_max_y + 20]
set arrow 1 from STATS_min_x, STATS_min_y - 8 rto 50, 0 heads size 2,90 linewidth 2 front
set label 1 "50 mm" at STATS_min_x + 25, STATS_min_y - 14 center front
unset colorbox
set lmargin at screen 0.01
set rmargin at screen 0.46
set title title font ",15"
plot whole index 1 using 1:2:3 with polygons fillcolor rgb variable fillstyle solid, \
     "" index 0 using 1:2:3:4 with vectors nohead linewidth 1.6 linecolor rgb "#2874a6", \
     NaN with points palette
set lmargin at screen 0.47
set rmargin at screen 0.91
unset arrow 1
unset label 1
set title second font ",15"
set colorbox user origin 0.925, 0.15 size 0.014, 0.6
plot part index 1 using 1:2:3 with polygons fillcolor rgb variable fillstyle solid, \
     "" index 0 using 1:2:3:4 with vectors nohead linewidth 1.6 linecolor rgb "#2874a6", \
     NaN with points palette
unset multiplot
