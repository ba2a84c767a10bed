# A film of the shift on a slice, with the ventricles as they were: gnuplot -e "folder='FOLDER'; out='FILE.gif'; last=K" shift.gp takes
# shift-0.plot to shift-K.plot. With the first and the last frame it waits.

set terminal gif animate delay 25 loop 0 size 500,600 font "DejaVu Sans,13"
set output out
stats folder."/shift-0.plot" using 3 nooutput
set cbrange [0:STATS_max]
set size ratio -1
set xrange [-78:78]
set yrange [-110:78]
unset tics
unset border
unset colorbox
set palette gray
set key at graph 0.5,-0.01 center top samplen 2
set lmargin 1
set rmargin 1
do for [step = 0 : last + 6] {
    frame = step < 3 ? 0 : step - 3 > last ? last : step - 3
    set title sprintf("%.0f %% of the load", 100. * frame / last)
    plot folder."/shift-".frame.".plot" using 1:2:3 with image notitle, \
         folder."/before.contour" using (1e3 * $1):(1e3 * $2) with lines lw 2 lc rgb "#30a0ff" title "ventricles before"
}
