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
    paste <(rows nodes.x cloud.mts) <(rows u cloud.mts) | awk '
        { r = $1 * $1 + $2 * $2; d = (1 - r) * exp(-r / 2) - $3; if (d < 0) d = -d; if (!(d < 1e-14)) bad = 1 }
        END { exit bad }'
}

@test "the same command, the same bytes; another seed, another cloud" {
    cloud -d 2 -k jittered -n 9 --box 0,1,0,1 --seed 3 > one.mts
    cloud -d 2 -k jittered -n 9 --box 0,1,0,1 --seed 3 -o two.mts
    cmp one.mts two.mts
    [ "$(cloud -d 2 -k jittered -n 9 --box 0,1,0,1 --seed 3 -t | rows nodes.x | cksum)" != \
      "$(cloud -d 2 -k jittered -n 9 --box 0,1,0,1 --seed 4 -t | rows nodes.x | cksum)" ]
    GSL_RNG_SEED=9 GSL_RNG_TYPE=taus cloud -d 2 -k jittered -n 9 --box 0,1,0,1 --seed 3 | cmp - one.mts
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
