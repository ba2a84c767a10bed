# The whole brain, deformed: gnuplot -e "surface='FILE'; slice='FILE'; out='FILE.png'" picture.gp
# surface is what surface.awk writes, slice what slice.awk does.

set terminal pngcairo size 1800,960 font "DejaVu Sans,14" background "white"
set output out

set palette defined (0 "#fcfdbf", 1 "#fec488", 2 "#fb8761", 3 "#e55064", 4 "#b5367a", 5 "#812581", 6 "#4f127b", 7 "#1c1044")
set cbrange [0:10]
set cblabel "displacement, mm" offset 1,0
set size ratio -1
set tics out nomirror
set border 31 linecolor rgb "#606060"
unset key

set multiplot
set bmargin at screen 0.09
set tmargin at screen 0.92

set lmargin at screen 0.05
set rmargin at screen 0.50
unset colorbox
set title "seen from the craniotomy (its rim in black)" font ",17"
set xrange [-112:80]
set yrange [-75:92]
set xlabel "to the front, mm"
set ylabel "up, mm"
stats surface nooutput
set pm3d map corners2color mean border retrace linecolor rgb "#806040" linewidth 0.3
splot surface index 1:STATS_blocks-1 using 1:2:3 with pm3d, \
      "" index 0 using 1:2:(0):3:4:(0) with vectors nohead linewidth 2.5 linecolor rgb "black"

set lmargin at screen 0.56
set rmargin at screen 0.92
set title "section at z = 20 mm: skull, outline at rest (blue) and deformed" font ",17"
set xrange [-75:75]
set yrange [-107:75]
set xlabel "x, mm"
set ylabel "y, mm"
set colorbox user origin 0.925, 0.18 size 0.012, 0.64
stats slice nooutput
set pm3d map corners2color mean border retrace linewidth 0.3
splot slice index 3:STATS_blocks-1 using 1:2:3 with pm3d, \
      "" index 1 using 1:2:(0):3:4:(0) with vectors nohead linewidth 1.8 linecolor rgb "#2874a6", \
      "" index 2 using 1:2:(0):3:4:(0) with vectors nohead linewidth 1.8 linecolor rgb "#6e2c1c", \
      "" index 0 using 1:2:(0):3:4:(0) with vectors nohead linewidth 3 linecolor rgb "black"
unset multiplot
