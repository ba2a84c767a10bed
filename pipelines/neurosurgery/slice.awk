# Values on a slice for gnuplot: awk -f slice.awk BEFORE PREDICTED TRUE, each what sample prints at the places of one grid, x first.
# Rows x y before predicted true, mm, a blank line behind each row of the grid.

FNR == 1 { file++ }
/^#/ || NF < 4 { next }
file < 3 { value[file, ++count[file]] = $4; next }
{
    i = ++count[3]
    if (i > 1 && $2 != last) print ""
    last = $2
    print $1, $2, value[1, i], value[2, i], $4
}
END { if (count[3] == 0 || count[1] != count[3] || count[2] != count[3]) exit 1 }
