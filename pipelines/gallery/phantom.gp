# The bar before and after: gnuplot -e "data='FILE'; out='FILE.png'" phantom.gp; rows x y z ux uy uz, m.
set terminal pngcairo size 760,560 font "DejaVu Sans,12" background "white"
set output out
set title "A bar of silicone under its weight" font ",14"
set size ratio -1
set xlabel "from the clamp, mm"
set ylabel "height, mm"
set xrange [-6:200]
set yrange [-130:16]
set tics out nomirror
set border 3 linecolor rgb "#606060"
set key bottom left Left reverse samplen 1
set object 1 rectangle from -6,-12 to 0,12 fillcolor rgb "#808080" fillstyle solid noborder
plot data using (1e3 * $3):(1e3 * $2) with points pt 7 ps 0.25 lc rgb "#7fb3d5" title "nodes before", \
     data using (1e3 * ($3 + $6)):(1e3 * ($2 + $5)) with points pt 7 ps 0.25 lc rgb "#b5367a" title "nodes after", \
     "+" using (128):(-116.25) every ::0::0 with points pt 1 ps 3 lw 3 lc rgb "black" title "tip as measured"
