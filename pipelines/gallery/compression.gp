# Nominal stress over stretch: gnuplot -e "data='FOLDER/compression'; rates='R R R'; out='FILE.png'" compression.gp
set terminal pngcairo size 700,480 font "DejaVu Sans,12" background "white"
set output out
set title "Brain tissue in unconfined compression, at three rates" font ",13"
set xlabel "stretch"
set ylabel "nominal stress, Pa"
set xrange [1:0.69]
set yrange [0:2400]
set key top left Left reverse
set grid
colour(n) = word("#b5367a #2874a6 #2e8b57", n)
name(n) = word("0.64 0.0064 6.4e-6", n)
plot for [n = 1:3] data."-".word(rates, n).".closed" using 1:(-$2) with lines lw 2 lc rgb colour(n) title name(n)." 1/s, closed form", \
     for [n = 1:3] data."-".word(rates, n).".rows" using 1:(-$2) with points pt 7 ps 1 lc rgb colour(n) notitle, \
     NaN with points pt 7 ps 1 lc rgb "black" title "these programs"
