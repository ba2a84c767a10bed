# Errors of a ball of layers under pressure, against Lame's solution u = A r + B / r^2 in each layer:
# awk -f pipelines/stream.awk -f pipelines/hard/ball.awk -v field=u.dat -v layers='REGION RADIUS E NU, ...' -v pressure=PA
#
# layers: from the inside. Prints `quantity<TAB>error`: of the displacement the mean over the nodes by the largest, of the stress in each
# layer the root mean square over its cells by the largest there.

function radial(k, r) { return bulk[k] * 3 * A[k] - 4 * shear[k] * B[k] / r ^ 3 }
function hoop(k, r) { return bulk[k] * 3 * A[k] + 2 * shear[k] * B[k] / r ^ 3 }
function size_of(k, r) { return sqrt(radial(k, r) ^ 2 + 2 * hoop(k, r) ^ 2) }

BEGIN {
    count = split(layers, text, /, */)
    A[1] = 1
    for (k = 1; k <= count; k++) {
        split(text[k], word, " ")
        name[k] = word[1]; end[k] = word[2]
        shear[k] = word[3] / 2 / (1 + word[4]); bulk[k] = word[3] / 3 / (1 - 2 * word[4])
        if (k > 1) {
            # u and the radial stress go on.
            r = end[k - 1]; u = A[k - 1] + B[k - 1] / r ^ 3; s = radial(k - 1, r)
            A[k] = (s + 4 * shear[k] * u) / (3 * bulk[k] + 4 * shear[k]); B[k] = (u - A[k]) * r ^ 3
        }
    }
    scale = -pressure / radial(count, end[count])
    for (k = 1; k <= count; k++) { A[k] *= scale; B[k] *= scale }

    read_stream(field, "")
    need_section("stress", "say `stress = yes` in the scene's [output]")
    for (n = 0; n < rows["nodes.x"]; n++) {
        r = sqrt(value["nodes.x", n, 0] ^ 2 + value["nodes.x", n, 1] ^ 2 + value["nodes.x", n, 2] ^ 2)
        for (k = 1; k < count && r > end[k] * (1 + 1e-9); k++);
        exact = A[k] * r + (k > 1 ? B[k] / r ^ 2 : 0)
        if (exact ^ 2 > largest ^ 2) largest = exact
        square = 0
        for (i = 0; i < 3; i++) square += (value["u", n, i] - (r > 0 ? exact * value["nodes.x", n, i] / r : 0)) ^ 2
        sum += sqrt(square)
    }
    printf "displacement, mean\t%.6g\n", sum / rows["nodes.x"] / (largest < 0 ? -largest : largest)

    regions = split(attribute["cells.region", "names"], region, ",")
    split("0 1 2 0 0 1", row, " "); split("0 1 2 1 2 2", col, " ")
    for (c = 0; c < rows["cells"]; c++) {
        for (k = 1; name[k] != region[value["cells.region", c, 0] + 1]; k++);
        r = 0
        for (i = 0; i < 3; i++) {
            x[i] = 0
            for (v = 0; v < 4; v++) x[i] += value["nodes.x", value["cells", c, v], i] / 4
            r += x[i] ^ 2
        }
        r = sqrt(r)
        square = 0
        for (i = 1; i <= 6; i++) {
            exact = (radial(k, r) - hoop(k, r)) * x[row[i]] * x[col[i]] / r ^ 2 + (row[i] == col[i] ? hoop(k, r) : 0)
            square += (value["stress", c, i - 1] - exact) ^ 2 * (row[i] == col[i] ? 1 : 2)
        }
        squares[k] += square; cells[k]++
        if (size_of(k, r) > most[k]) most[k] = size_of(k, r)
    }
    for (k = 1; k <= count; k++) printf "stress in the %s, root mean square\t%.6g\n", name[k], sqrt(squares[k] / cells[k]) / most[k]
}
