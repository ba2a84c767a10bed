# Adaptive integration by ipoints -a.

load common.bash

setup() {
    enter
    cloud -d 2 -k jittered -n 9 --box 0,0.1,0,0.1 --jitter 0.3 > square.mts
}

@test "wrong command lines are refused with status 2, before the input is read" {
    for arguments in "-a" "-a 0" "-a -1" "-a nan" "-a 0.1 -c" "-a 0.1 --lattice 3,3" "-a 0.1 --levels 11" "-a 0.1 --levels -1" \
        "--levels 3" "-k 2" "-R 8mm" "-b mls1" "--mu 1" "-g 3 -w regularised" "-a 0.1 -k 2 -R 8mm" "-a 0.1 -b mls3" "-a 0.1 -k 0"; do
        run -2 --separate-stderr ipoints $arguments < /dev/null
        [[ "$stderr" == "ipoints: "* ]]
        [[ "$stderr" != *"standard input"* ]]
    done
    refused 2 "no rule of 5 points" ipoints -a 0.1 -g 5 square.mts
}

@test "the shape functions are those recorded in the stream, or those asked for" {
    ipoints -g 3 square.mts | support -k 2.4 -b mls1 -w regularised > lists.mts
    ipoints -a 0.1 -k 2.4 -b mls1 -w regularised square.mts | mts print points.x > asked
    ipoints -a 0.1 lists.mts | mts print points.x | cmp - asked
    run ! cmp -s asked <(ipoints -a 0.1 -k 2.4 square.mts | mts print points.x)
    ipoints -a 0.1 -b mmls2 -w quartic -k 2.4 lists.mts | mts print points.x |
        cmp - <(ipoints -a 0.1 -k 2.4 square.mts | mts print points.x)
    run ! mts print support.radius <(ipoints -a 0.1 lists.mts)
    ipoints -a 0.1 -R 30mm square.mts | mts print points.x | cmp - <(ipoints -a 0.1 -R 0.03 square.mts | mts print points.x)
}

@test "an unfit support is a verdict that names the point" {
    run -1 --separate-stderr ipoints -a 0.1 -b mls2 -k 0.2 <(cloud -d 2 -k regular -n 3 --box 0,1,0,1)
    [[ "$stderr" == *"no good support"* ]]
    [ -z "$output" ]
}
