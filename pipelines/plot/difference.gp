# Maps of the difference from the reference, side by side on one scale:
# gnuplot -e "data='FILE...'; titles='TITLE|...'; most=MM; out='FILE.png'" difference.gp
# data are what difference.awk writes; differences beyond `most` mm are green.

count = words(data)
cut(text, bar) = bar == 0 ? text : text[1:bar - 1]
rest(text, k) = k == 1 ? text : rest(text[strstrt(text, "|") + 1:*], k - 1)
part(k) = cut(rest(titles, k), strstrt(rest(titles, k), "|"))

width = 420
set terminal pngcairo size count * width + 240, 700 font "DejaVu Sans,14" background "white"
set output out
left = 110.0 / (count * width + 240)
step = width * 1.0 / (count * width + 240)

# The last tenth of the scale is one colour, for all that exceeds it.
set palette maxcolors 200 defined (0 "#fcfdbf", 1 "#fec488", 2 "#fb8761", 3 "#e55064", 4 "#b5367a", 5 "#812581", 6 "#4f127b", 7 "#1c1044", \
    7.001 "#1e9e5a", 7.7 "#1e9e5a")
set pm3d map corners2color mean interpolate 6,6 border retrace
set cbrange [0:1.1 * most]
set cbtics 0, most / 6
set cbtics add ("more" 1.05 * most)
set cblabel "difference from the reference, mm" offset 1,0
set size ratio -1
set xrange [-72:74]
set yrange [-105:73]
set tics out nomirror
set border 31 linecolor rgb "#606060"
set xtics -60,20,60
set xlabel "x, mm" 
unset key

set multiplot
do for [k = 1:count] {
    set lmargin at screen left + (k - 1) * step
    set rmargin at screen left + (k - 1) * step + 0.94 * step
    set bmargin at screen 0.15
    set tmargin at screen 0.87
    set title part(k) offset 0,0.3
    if (k == 1) { set ylabel "y, mm" ; set format y "%g" } else { unset ylabel; set format y "" }
    if (k == count) {
        set colorbox user origin left + count * step, 0.18 size 0.010, 0.64
    } else { unset colorbox }
    stats word(data, k) nooutput
    splot word(data, k) index 1:STATS_blocks-1 using 1:2:3 with pm3d, \
          "" index 0 using 1:2:(0):3:4:(0) with vectors nohead linewidth 1.2 linecolor rgb "black"
}
unset multiplot
