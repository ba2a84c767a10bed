# cloud: clouds without a mesher.

load common.bash

setup() { enter_loosely; }

@test "the cloud of the approximation study" {
    cloud -d 2 -k regular -n 18 --box -4,4,-4,4 --field paper -t > cloud.mts
    [ "$(rows nodes.x cloud.mts | wc -l)" -eq 324 ]
    [ "$(rows nodes.x cloud.mts | head -n 1)" = "-4 -4" ]
    [ "$(rows nodes.x cloud.mts | tail -n 1)" = "4 4" ]
    [ "$(rows cells cloud.mts | wc -l)" -eq 578 ]
    [ "$(rows facets cloud.mts | wc -l)" -eq 68 ]
    grep -q '^# cells.region .* names=body$' cloud.mts
    grep -q '^# facets.set .* names=xmin,xmax,ymin,ymax$' cloud.mts
}

@test "jitter moves inner nodes by no more than it may, those of the boundary not at all, by the seed, and the cells fill the box" {
    cloud -d 2 -k jittered -n 9 --box 0,1,0,1 --seed 3 > one.mts
    GSL_RNG_SEED=9 GSL_RNG_TYPE=taus cloud -d 2 -k jittered -n 9 --box 0,1,0,1 --seed 3 | cmp - one.mts
    ! cloud -d 2 -k jittered -n 9 --box 0,1,0,1 --seed 4 | cmp -s - one.mts
    cloud -d 2 -k jittered -n 40 --box -1,3,0,1 --jitter 0.5 --seed 7 > jittered.mts
    cloud -d 2 -k regular -n 40 --box -1,3,0,1 > regular.mts
    paste <(mts print nodes.x jittered.mts) <(mts print nodes.x regular.mts) | awk '
        { inner = $3 > -1 && $3 < 3 && $4 > 0 && $4 < 1
          for (i = 1; i <= 2; i++) { d = ($i - $(i + 2)) * 39 / (i == 1 ? 4 : 1); d = d < 0 ? -d : d; sum += d; most = d > most ? d : most; bad += !inner && d != 0 } }
        END { mean = sum / (2 * 38 * 38); exit bad || !(most <= 0.5 * (1 + 1e-9) && most > 0.49 && mean > 0.23 && mean < 0.27) }'
    mts check jittered.mts
    ipoints jittered.mts | mts print points.weight | awk '{ sum += $1 } END { exit !(sum / 4 - 1 < 1e-13 && 1 - sum / 4 < 1e-13) }'
    # graded: steps in geometric sequence, the last eight times the first
    cloud -d 2 -k graded -n 5,4 --box -1,3,0,1 --ratio 8 | mts print nodes.x | awk 'NR <= 5 { x[NR] = $1 } END { a = x[2] - x[1]
        near = (x[5] - x[4]) / a / 8 - 1; next_ = (x[3] - x[2]) / a / 2 - 1; exit !(x[1] == -1 && x[5] == 3 && near ^ 2 < 1e-22 && next_ ^ 2 < 1e-22) }'
}

@test "fields are what they say, in 2D and 3D" {
    for dim in 2 3; do
        for field in paper linear quadratic; do
            cloud -d $dim -k regular -n 4 --box -2,0.5,0,3$([ $dim = 2 ] || echo ,-1,2) --field $field > cloud.mts
            paste <(mts print nodes.x cloud.mts) <(mts print u cloud.mts) | awk -v field=$field -v dim=$dim '
                { x = $1; y = $2; z = dim == 3 ? $3 : 0; r = x * x + y * y + z * z; linear = 1 + 2 * x + 3 * y + 4 * z
                  is = field == "paper" ? (1 - r) * exp(-r / 2) : linear + (field == "linear" ? 0 : x * x - 2 * x * y + 3 * y * y + x * z - y * z + 2 * z * z)
                  d = $(dim + 1) - is; if (!(d * d < 1e-25)) { print; bad = 1 } } END { exit bad || NR != 4 ^ dim }'
        done
    done
}

@test "jitter that turns tetrahedra over leaves the cells out, with a note" {
    run -0 --separate-stderr cloud -d 3 -k jittered -n 12 --box 0,1,0,1,0,1 -t
    [[ "$stderr" == "cloud: jitter 0.5 turns tetrahedra over: cells and facets are left out" ]]
    [[ "$output" != *"# cells"* ]]
}

@test "usage errors" {
    refused 2 "--kind is missing" cloud -d 2 -n 4 --box 0,1,0,1
    refused 2 "--box is missing" cloud -d 2 -k regular -n 4
    refused 2 "'square' is none of regular, jittered, halton, graded" cloud -d 2 -k square -n 4 --box 0,1,0,1
    refused 2 "-d: 4 is not within [2, 3]" cloud -d 4 -k regular -n 4 --box 0,1,0,1
    refused 2 "--box: 4 numbers, not 6" cloud -d 3 -k regular -n 4 --box 0,1,0,1
    refused 2 "box: 1,1 along axis 2 is no range" cloud -d 2 -k regular -n 4 --box 0,1,1,1
    refused 2 "-n: 3 numbers" cloud -d 2 -k regular -n 4,4,4 --box 0,1,0,1
    refused 2 "-n: 2 numbers, not 1" cloud -d 2 -k halton -n 4,4 --box 0,1,0,1
    refused 2 "-n: 4.5 is not a whole number" cloud -d 2 -k regular -n 4.5 --box 0,1,0,1
    refused 2 "1 nodes along axis 1" cloud -d 2 -k regular -n 1,4 --box 0,1,0,1
    refused 2 "more than 2147483647 nodes" cloud -d 3 -k regular -n 2000 --box 0,1,0,1,0,1
    refused 2 "--jitter goes with another kind" cloud -d 2 -k regular -n 4 --box 0,1,0,1 --jitter 0.1
    refused 2 "--seed goes with another kind" cloud -d 2 -k graded -n 4 --box 0,1,0,1 --seed 1
    refused 2 "--ratio goes with another kind" cloud -d 2 -k halton -n 4 --box 0,1,0,1 --ratio 2
    refused 2 "jitter: 0.6 is not within" cloud -d 2 -k jittered -n 4 --box 0,1,0,1 --jitter 0.6
    refused 2 "--field: 'sine' is none of paper, linear, quadratic" cloud -d 2 -k regular -n 4 --box 0,1,0,1 --field sine
    refused 2 "unexpected operand" cloud -d 2 -k regular -n 4 --box 0,1,0,1 file
}
