# A round of Gauss and Newton's method: awk -f common.awk -f step.awk -v round=K -v at=ROUND -v folder=FOLDER -v dim=DIM PARAMETERS
#
# Least of all is J(p) = sum ((m - u(p)) / s)^2 + sum ((p - mean) / deviation)^2, with m what was measured to s (FOLDER/measured.tsv) and
# u(p) what was computed (ROUND/trial.u and, for derivatives, ROUND/more_NAME.u). FOLDER/state.tsv keeps the best parameters so far, their J
# in its first row, and the step from them to the trial. Where J has grown the step is halved. Where the next step changes
# (sum (du / s)^2 / number)^(1/2) by less than a tenth, the trial is written to FOLDER/identified.tsv.

BEGIN {
    FS = OFS = "\t"
    CONVFMT = OFMT = "%.17g"
}

{ take_parameter() }

END {
    if (failed) exit 2
    read_state()
    read_measured()
    read_displacements("trial", residual)
    misfit = 0
    for (r = 1; r <= rows; r++) {
        residual[r] = (measured[r] - residual[r]) / scatter[r]
        misfit += residual[r] ^ 2
    }
    objective = misfit
    for (i = 1; i <= count; i++) objective += ((trial[i] - mean[i]) / deviation[i]) ^ 2

    line = sprintf("round %d\tmisfit %.3f", round, sqrt(misfit / rows))
    for (i = 1; i <= count; i++) line = line OFS sprintf("%s %.5g", name[i], trial[i])
    if (round > 1 && objective > best_objective) {
        print line OFS "misfit grows: half the step"
        for (i = 1; i <= count; i++) step[i] /= 2
        write_state(best_objective, best)
        exit
    }
    print line

    read_derivatives()
    solve_normal_equations()
    change = 0
    for (r = 1; r <= rows; r++) {
        du = 0
        for (i = 1; i <= count; i++) du += derivative[i, r] * step[i]
        change += du ^ 2
    }
    if (sqrt(change / rows) < 0.1) write_identified()
    else write_state(objective, trial)
}

function read_state(    i) {
    for (i = 1; i <= count; i++) trial[i] = mean[i]
    if (round == 1) return
    getline < (folder "/state.tsv")
    best_objective = $2
    for (i = 1; i <= count; i++) {
        getline < (folder "/state.tsv")
        best[i] = $2
        step[i] = $3
        trial[i] = $2 + $3
    }
    close(folder "/state.tsv")
}

function write_state(objective, from,    i) {
    print "objective", objective > (folder "/state.tsv")
    for (i = 1; i <= count; i++) print name[i], from[i], step[i] > (folder "/state.tsv")
}

# One row for each component of each point.
function read_measured(    k) {
    while ((getline < (folder "/measured.tsv")) > 0)
        for (k = 1; k <= dim; k++) {
            measured[++rows] = $(dim + k)
            scatter[rows] = $(2 * dim + 1)
        }
}

function read_displacements(which, values,    file, r, k, part) {
    file = at "/" which ".u"
    r = 0
    while ((getline < file) > 0) {
        split($0, part, /[ \t]+/)
        for (k = 1; k <= dim; k++) values[++r] = part[k]
    }
    close(file)
    if (r != rows) die(file ": displacements of " r / dim " points and not of " rows / dim)
}

# derivative[i, r]: of component r, in deviations of the measurement, to parameter i.
function read_derivatives(    i, r, values) {
    for (i = 1; i <= count; i++) {
        read_displacements("more_" name[i], values)
        for (r = 1; r <= rows; r++) derivative[i, r] = ((values[r] - measured[r]) / scatter[r] + residual[r]) / (deviation[i] / 10)
    }
}

# (D'D + C^-1) step = D' residual - C^-1 (p - mean), by Cholesky's factors; after[i]: what is left of the deviation of parameter i.
function solve_normal_equations(    i, j, k, r, matrix, factor, y, sum) {
    for (i = 1; i <= count; i++) {
        step[i] = -(trial[i] - mean[i]) / deviation[i] ^ 2
        for (r = 1; r <= rows; r++) step[i] += derivative[i, r] * residual[r]
        for (j = 1; j <= i; j++) {
            sum = i == j ? 1 / deviation[i] ^ 2 : 0
            for (r = 1; r <= rows; r++) sum += derivative[i, r] * derivative[j, r]
            for (k = 1; k < j; k++) sum -= factor[i, k] * factor[j, k]
            factor[i, j] = i == j ? sqrt(sum) : sum / factor[j, j]
        }
    }
    substitute(factor, step)
    for (i = 1; i <= count; i++) {
        for (j = 1; j <= count; j++) y[j] = j == i
        substitute(factor, y)
        after[i] = sqrt(y[i])
    }
}

function substitute(factor, x,    i, k) {
    for (i = 1; i <= count; i++) {
        for (k = 1; k < i; k++) x[i] -= factor[i, k] * x[k]
        x[i] /= factor[i, i]
    }
    for (i = count; i >= 1; i--) {
        for (k = i + 1; k <= count; k++) x[i] -= factor[k, i] * x[k]
        x[i] /= factor[i, i]
    }
}

function write_identified(    i, file) {
    file = folder "/identified.tsv"
    print "name", "value", "deviation", "mean_before", "deviation_before" > file
    for (i = 1; i <= count; i++) {
        printf "%s\t%.6g\t%.3g\t%.6g\t%.6g\n", name[i], trial[i], after[i], mean[i], deviation[i] > file
        if (after[i] > 0.9 * deviation[i])
            print "identify: parameter '" name[i] "': the points hardly tell it, its deviation stays" > "/dev/stderr"
    }
}
