# Counts cases. The script that sources this has a directory $work, and writes to $work/out what a case prints.
passed=0 failed=0
report() { # report NAME OUTCOME
    if [ "$2" = 0 ]; then
        passed=$((passed + 1))
        echo "ok     $1"
    else
        failed=$((failed + 1))
        echo "FAILED $1"
        tail -n 12 "$work/out" | sed 's/^/         /'
    fi
}
case_of() { # case_of NAME COMMAND...
    "${@:2}" > "$work/out" 2>&1 < /dev/null
    report "$1" $?
}
same_bits() { # same_bits NAME FILM FILM
    "$host" compare "$2" "$3" > "$work/out" 2>&1
    grep -q 'equal to the bit' "$work/out"
    report "$1" $?
}
# unit_tests RUN PROGRAM [FILTERS...]: runs the library's tests with the command RUN, and shows those that failed
unit_tests() {
    "$1" "$2" --test-threads "$(nproc)" "${@:3}" > "$work/out" 2>&1
    report 'unit tests' $?
    grep -E '^test result|^test .* FAILED' "$work/out"
}
summary() {
    echo "$passed passed, $failed failed"
    [ "$failed" = 0 ]
}
