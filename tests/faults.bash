# What the tests of faults.bats are written with. Each case that is tried leaves a row in the file that FAULTS names:
# test, case, status, the line on standard error, and whether the tool survived it as it should.

# THOROUGH=1: every byte and every allocation in turn; else every so many.
every() { [ -n "${THOROUGH:-}" ] && echo 1 || echo "$1"; }

record() { # CASE STATUS MESSAGE yes|no
    printf '%s\t%s\t%s\t%s\t%s\n' "$BATS_TEST_DESCRIPTION" "$1" "$2" "${3//$'\t'/ }" "$4" >> "${FAULTS:-/dev/null}"
}

# refused CASE STATUS TEXT COMMAND: that exit status; one line on standard error, `program: ...TEXT...`; no output that a
# later stage takes for a stream; and with -o an existing file stays, nothing lies beside it.
refused() {
    local what=$1 expected=$2 text=$3 command=$4 status=0 second=0 survived=yes message
    rm -rf kept && mkdir kept && echo precious > kept/file
    bash -o pipefail -c "$command" > out 2> message || status=$?
    bash -o pipefail -c "$command -o kept/file" > /dev/null 2>&1 || second=$?
    message=$(cat message)
    if [ "$status" -ne "$expected" ] || [ "$(wc -l < message)" -ne 1 ] || [[ $message != *": "*"$text"* ]] ||
        mts list out > /dev/null 2>&1 ||
        [ "$second" -ne "$expected" ] || [ "$(cat kept/file)" != precious ] || [ "$(ls -A kept)" != file ]; then
        survived=no
        echo "$what: status $status, with -o $second (not $expected); message '$message'; kept: $(ls -A kept)"
    fi
    record "$what" "$status" "$message" "$survived"
    [ "$survived" = yes ]
}

# accepted CASE COMMAND: what looks like a fault and is none: status 0, and the output is a whole stream.
accepted() {
    local status=0 survived=yes
    bash -o pipefail -c "$2" > out 2> message || status=$?
    if [ "$status" -ne 0 ] || ! mts check out > /dev/null; then
        survived=no
        echo "$1: status $status: $(cat message)"
    fi
    record "$1" "$status" "$(head -n 1 message)" "$survived"
    [ "$survived" = yes ]
}
