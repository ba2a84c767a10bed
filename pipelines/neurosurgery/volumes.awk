# Volumes of labels: awk -f volumes.awk -v titles=TITLES LABELS REPORT..., a label table and what warp -v -i nearest says of the predicted
# images, which TITLES names (separated by tabs), and of the true one.

BEGIN { OFS = "\t" }
FNR == 1 { file++ }
file == 1 && !/^#/ { label[++count] = $1; name[$1] = $2; next }
$2 == "label" { sub(":", "", $3); before[$3] = $4; after[file, $3] = $7 }

END {
    print "label, ml", "before", titles, "true"
    for (i = 1; i <= count; i++) {
        l = label[i]
        printf "%s\t%.1f", name[l], before[l]
        for (f = 2; f < ARGC; f++) {
            if (!((f, l) in after)) {
                print "volumes.awk: no volume of label " l " in report " f - 1 > "/dev/stderr"
                exit 1
            }
            printf "\t%.1f", after[f, l]
        }
        print ""
    }
}
