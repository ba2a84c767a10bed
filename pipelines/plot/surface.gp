# The approximated surface: gnuplot -e "data='FILE'; out='FILE.png'" surface.gp; data are rows x y u of a lattice.

set terminal pngcairo size 1000,760 font "DejaVu Sans,14" background "white"
set output out
set title "MMLS through 18 x 18 values of (1 - r^2) exp(-r^2/2), {/Symbol m} = 0.1, R = 0.8" font ",16"
set palette defined (0 "#3b4cc0", 1 "#8db0fe", 2 "#dddddd", 3 "#f49a7b", 4 "#b40426")
set pm3d depthorder border linecolor rgb "#404040" linewidth 0.15
set view 60,318,1.05,1.2
set colorbox user origin 0.93,0.3 size 0.018,0.45
set ticslevel 0.1
set xlabel "x"
set ylabel "y"
set zlabel "u" rotate by 90
set xtics -4,2,4
set ytics -4,2,4
set zrange [-0.5:1]
set ztics -0.4,0.2,1
set cbrange [-0.45:1]
unset cblabel
set border 31 linecolor rgb "#606060"
unset key

splot data using 1:2:3 with pm3d
