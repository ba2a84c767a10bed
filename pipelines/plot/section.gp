# The deformed section: gnuplot -e "data='FILE'; skull='FILE'; load='FILE'; title='TEXT'; out='FILE.png'" section.gp
# data is what section.awk writes; skull and load are tables of the scene, mm.

set terminal pngcairo size 1000,1260 font "DejaVu Sans,15" background "white"
set output out
set title title font ",18"
set size ratio -1
set xlabel "x, mm"
set ylabel "y, mm"
set tics out nomirror
set border 3 linecolor rgb "#606060"
set xrange [-76:76]
set yrange [-107:76]
set key below horizontal maxrows 2 samplen 2.5 spacing 1.2 width -1 font ",14"

plot data index "region parenchyma" with filledcurves closed linecolor rgb "#f3dcd0" title "parenchyma", \
     data index "region tumour" with filledcurves closed linecolor rgb "#d98880" title "tumour", \
     for [name in "parenchyma tumour"] data index "region ".name with lines linewidth 0.6 linecolor rgb "#a07868" notitle, \
     data index "outline deformed" with lines linewidth 2 linecolor rgb "#6e2c1c" title "outline after", \
     data index "inner deformed" with lines linewidth 2 linecolor rgb "#6e2c1c" notitle, \
     data index "outline undeformed" with lines linewidth 1.6 linecolor rgb "#2874a6" title "outline before", \
     data index "inner undeformed" with lines linewidth 1.6 linecolor rgb "#2874a6" notitle, \
     load using 1:2 with lines linewidth 4 linecolor rgb "#7fb3d5" title "opening before", \
     skull using 1:2 with lines linewidth 3 linecolor rgb "black" title "skull"
