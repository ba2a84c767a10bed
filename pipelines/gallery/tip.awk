# Rows of phantom.tsv: awk -f pipelines/stream.awk -f tip.awk -v field=STREAM
#
# The mean place of the far end of the bar, in mm: how far down, how far from the clamp, its distance from the measured place in percent of
# the length (the ratio is to 2 %), and the first two against the elastica.

BEGIN {
    read_stream(field, "")
    need_section("u", "run mtled")
    for (i = 0; i < rows["u"]; i++) {
        if (value["nodes.x", i, 2] < 0.18199) continue
        down -= 1e3 * (value["nodes.x", i, 1] + value["u", i, 1])
        away += 1e3 * (value["nodes.x", i, 2] + value["u", i, 2])
        count++
    }
    if (count == 0) die(field ": no nodes at the tip")
    down /= count
    away /= count
    row("tip, mm down: measured", down, 116.25)
    row("tip, mm away: measured", away, 128)
    row("distance, % of length", 100 * sqrt((down - 116.25)^2 + (away - 128)^2) / 182, 2)
    row("tip, mm down: thin beam", down, 119.527)
    row("tip, mm away: thin beam", away, 128.724)
}

function row(name, ours, reference) {
    printf "%s\t%d\t%.3f\t%.3f\t%.4f\n", name, rows["u"], ours, reference, ours / reference
}
