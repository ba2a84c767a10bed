# Where the tumour comes to lie: gnuplot -e "section='FILE'; place='FILE'; title='TEXT'; out='FILE.png'" picture.gp
# section is what section.awk writes for one case, place what place.awk writes; mm.

set terminal pngcairo size 1500,760 font "DejaVu Sans,13" background "white"
set output out
set multiplot layout 1,3 title title font ",16"
set size ratio -1
set xlabel "x, mm"
set ylabel "y, mm"
set tics out nomirror
set border 3 linecolor rgb "#606060"
set key below vertical samplen 2.5 spacing 1.2 font ",12"

set xrange [-76:76]
set yrange [-107:76]
plot section index "outline undeformed" with lines linewidth 1.2 linecolor rgb "#2874a6" title "outline before", \
     section index "outline deformed" with lines linewidth 1.2 linecolor rgb "#6e2c1c" title "outline after, one sample", \
     place index "rest" with filledcurves closed linecolor rgb "#aed6f1" title "tumour before", \
     place index "mean" with filledcurves closed linecolor rgb "#d98880" title "tumour after, mean of the samples"

stats place index "band" using 1 prefix "X" nooutput
stats place index "band" using 2 prefix "Y" nooutput
half = 0.55 * (X_max - X_min > Y_max - Y_min ? X_max - X_min : Y_max - Y_min)
set xrange [(X_min + X_max) / 2 - half:(X_min + X_max) / 2 + half]
set yrange [(Y_min + Y_max) / 2 - 1.2 * half:(Y_min + Y_max) / 2 + 1.2 * half]
plot place index "outlines" with lines linewidth 0.3 linecolor rgb "#c0c0c0" title "the samples", \
     place index "band" using 3:4 with lines linewidth 1.6 linecolor rgb "#b9770e" title "95 % band of each node, along the normal", \
     place index "band" using 5:6 with lines linewidth 1.6 linecolor rgb "#b9770e" notitle, \
     place index "mean" with lines linewidth 2 linecolor rgb "#6e2c1c" title "mean"

# Of two normal variables the ellipse that holds 95 % has the radius sqrt(5.991) in units of their deviations.
stats place index "centres" using 2:3 prefix "C" nooutput
stats place index "centres" using (($2 - C_mean_x) * ($3 - C_mean_y)) prefix "P" nooutput
sxx = C_stddev_x**2
syy = C_stddev_y**2
sxy = P_mean
big = (sxx + syy) / 2 + sqrt(((sxx - syy) / 2)**2 + sxy**2)
small = (sxx + syy) / 2 - sqrt(((sxx - syy) / 2)**2 + sxy**2)
angle = 0.5 * atan2(2 * sxy, sxx - syy)
a = sqrt(5.991 * big)
b = sqrt(5.991 * small)
reach = 1.6 * a
set xrange [C_mean_x - reach:C_mean_x + reach]
set yrange [C_mean_y - 1.2 * reach:C_mean_y + 1.2 * reach]
set xtics 0.2
set parametric
set trange [0:2 * pi]
plot place index "centres" using 2:3 with points pointtype 7 pointsize 0.5 linecolor rgb "#7f8c8d" title "centre of the tumour, each sample", \
     C_mean_x + a * cos(t) * cos(angle) - b * sin(t) * sin(angle), C_mean_y + a * cos(t) * sin(angle) + b * sin(t) * cos(angle) \
         with lines linewidth 1.6 linecolor rgb "#b9770e" title "ellipse of 95 % (normal distribution)", \
     "+" using (C_mean_x):(C_mean_y) every ::0::0 with points pointtype 2 pointsize 2 linewidth 2 linecolor rgb "#6e2c1c" title "mean"
unset multiplot
