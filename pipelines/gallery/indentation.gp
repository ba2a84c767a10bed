# Force over depth: gnuplot -e "data='indentation.tsv'; out='FILE.png'" indentation.gp
set terminal pngcairo size 640,460 font "DejaVu Sans,12" background "white"
set output out
set title "A ball of 10 mm in radius pressed into tissue, E = 3 kPa" font ",13"
set xlabel "depth, mm"
set ylabel "force, mN"
set xrange [0:0.65]
set yrange [0:*]
set key top left Left reverse
set grid
plot 1e3 * 4 / 3. * 3000 / (1 - 0.45 ** 2) * sqrt(0.01) * (1e-3 * x) ** 1.5 with lines lw 2 lc rgb "#2874a6" title "Hertz, small loads", \
     data skip 1 using 1:(1e3 * $2) with points pt 7 ps 1.2 lc rgb "#b5367a" title "these programs, states of equilibrium"
