# Rows x y z ux uy uz, mm, with noise in each component of the displacement, and its standard deviation:
# awk -f random.awk -f noisy.awk -v noise=0.5 PLACES MOVES, mm and m

FNR == 1 { file++ }
file == 1 { place[FNR] = $1 "\t" $2 "\t" $3; n = FNR; next }
{ printf "%s\t%.3f\t%.3f\t%.3f\t%g\n", place[FNR], 1e3 * $1 + noise * normal(), 1e3 * $2 + noise * normal(), 1e3 * $3 + noise * normal(), noise }
END { if (file != 2 || FNR != n) exit 1 }
