# Vertical stress in the cells of the block: gnuplot -e "data='block.tsv'; out='block.png'" stress.gp, data by stress.awk
set terminal pngcairo size 700,470 font "DejaVu Sans,11"
set output out
set size ratio -1
set xlabel "x, mm"; set ylabel "y, mm"; set cblabel "vertical stress, kPa" offset 1.5,0; unset key
set palette defined (0 "#440154", 1 "#3b528b", 2 "#21918c", 3 "#5ec962", 4 "#fde725")
plot data with filledcurves closed lc palette
