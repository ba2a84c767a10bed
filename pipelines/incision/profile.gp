# Openings beside the ellipse: gnuplot -e "folder='...'; out='...'" profile.gp
set terminal pngcairo size 900,380 font "DejaVu Sans,11"
set output out
set multiplot layout 1,2
set xlabel "distance from the middle, radii"; set ylabel "half opening, of the exact one in the middle"
set xrange [0:1.02]; set yrange [0:1.05]; set key bottom left samplen 1
do for [case in "slit penny"] {
    set title case eq "slit" ? "slit, plane strain" : "penny-shaped crack"
    plot sqrt(1 - x * x) lc "black" title "exact", \
         folder."/".case."-5.profile" pt 6 ps 0.8 lc "#fb8761" title "5 nodes a radius", \
         folder."/".case."-10.profile" pt 2 ps 0.6 lc "#b5367a" title "10", \
         folder."/".case."-20.profile" pt 7 ps 0.3 lc "#2874a6" title "20"
}
