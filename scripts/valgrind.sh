#!/usr/bin/env bash
# Drives the FMU's library under valgrind's memcheck: invalid reads and writes, uninitialised values, and memory that nobody can free any
# more end with exit code 1. Needs valgrind and a C compiler; takes some minutes.
#
#   bash scripts/valgrind.sh [RANDOM_SECONDS]    also random calls for so many seconds; 60 by default, 0 for none
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-60}
built=${CARGO_TARGET_DIR:-target}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cargo build --release --locked --all-features
token=$(sed -nE 's/^ *guid="(.*)"$/\1/p' modelDescription/fmi2.xml)
load=$(sed -nE 's/.*name="load" valueReference="([0-9]+)".*/\1/p' modelDescription/fmi2.xml)
cc -O1 -g -o "$work/run_library" scripts/run_library.c -ldl

# What threads keep until they end and the loader's own tables can still be reached; the rest may not be there.
check() {
    valgrind --quiet --error-exitcode=1 --leak-check=full --show-leak-kinds=definite,indirect \
        --errors-for-leak-kinds=definite,indirect --num-callers=30 "$@"
}

echo "one state and one step:"
check "$work/run_library" "$built/release/libcartilage_contact.so" "$token" "$load"

tests=$(cargo test --release --locked --all-features --no-run --test c_abi 2>&1 | sed -nE 's/.*Executable .*\((.*c_abi-[0-9a-f]+)\)/\1/p')
echo "values, states, random calls:"
check "$tests" --test-threads 1 values random_calls_are_answered
if [ "$seconds" -gt 0 ]; then
    echo "more random calls:"
    RANDOM_SECONDS=$seconds check "$tests" --test-threads 1 --ignored --nocapture very_many_random_calls
fi
echo "valgrind found nothing"
