# Volumes of labels: awk -f volumes.awk LABELS PREDICTED TRUE, a label table and what warp -v -i nearest says.

BEGIN { OFS = "\t" }
FNR == 1 { file++ }
file == 1 && !/^#/ { label[++count] = $1; name[$1] = $2; next }
$2 == "label" { sub(":", "", $3); before[$3] = $4; after[file, $3] = $7 }

END {
    print "label", "before, ml", "predicted", "true"
    for (i = 1; i <= count; i++) {
        l = label[i]
        if (!((2, l) in after && (3, l) in after)) {
            print "volumes.awk: no volume of label " l > "/dev/stderr"
            exit 1
        }
        printf "%s\t%.1f\t%.1f\t%.1f\n", name[l], before[l], after[2, l], after[3, l]
    }
}
