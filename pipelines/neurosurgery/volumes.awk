# Volumes of labels: awk -v titles=TITLES -f volumes.awk LABELS VOLUMES..., a label table and files with rows of a label and its volume, ml: of
# the image before, of the predicted ones, which TITLES names (separated by tabs), and of the true one.

BEGIN { OFS = "\t" }
FNR == 1 { file++ }
file == 1 && !/^#/ { label[++count] = $1; name[$1] = $2 }
file > 1 { volume[file, $1] = $2 }

END {
    print "label, ml", "before", titles, "true"
    for (i = 1; i <= count; i++) {
        printf "%s", name[label[i]]
        for (f = 2; f <= file; f++) {
            if (!((f, label[i]) in volume)) {
                print "volumes.awk: " ARGV[f] " has no label " label[i] > "/dev/stderr"
                exit 1
            }
            printf "\t%.1f", volume[f, label[i]]
        }
        print ""
    }
}
