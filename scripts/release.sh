#!/usr/bin/env bash
# Builds the FMUs for as many platforms as this machine has the tools for, into target/fmu/release (or below
# CARGO_TARGET_DIR), checks the libraries, and says what was left out.
#
#   linux64  always: linked by zig (from PyPI), so that any Linux with glibc 2.17 or newer (2012) can load it
#   win64    with mingw-w64 (x86_64-w64-mingw32-gcc) and Rust's target x86_64-pc-windows-gnu; run if there is a wine
#   aarch64  with Rust's target aarch64-unknown-linux-gnu; linked by zig; FMI 3.0 only, FMI 2.0 has no name for it;
#            run if there are qemu-aarch64 and libc6-arm64-cross
set -eu
cd "$(dirname "$0")/.."

GLIBC=2.17
ZIG=0.17.1
CARGO_ZIGBUILD=0.24.0
FUNCTIONS=109 # 34 of FMI 2.0 co-simulation, 75 of FMI 3.0
built=${CARGO_TARGET_DIR:-target}
tools=$built/release-tools
output=$built/fmu/release
flags=(--release --lib --no-default-features --locked)
library=libcartilage_contact.so

if ! "$tools/bin/cargo-zigbuild" --version 2>/dev/null | grep -q "$CARGO_ZIGBUILD"; then
    python3 -m venv --clear "$tools"
    "$tools/bin/python" -m pip install --quiet "ziglang==$ZIG" "cargo-zigbuild==$CARGO_ZIGBUILD"
fi
export PATH="$(realpath "$tools")/bin:$PATH"

# Rust's standard library for a target: installed, or to be had from rustup.
has_target() {
    [ -d "$(rustc --print sysroot)/lib/rustlib/$1/lib" ] || timeout 60 rustup target add "$1" >/dev/null 2>&1
}

# Whether a table of symbols has all functions of both standards.
has_functions() {
    local found
    found=$(grep -cE '\bfmi[23][A-Z]\w+$' || true)
    echo "$1 exports $found functions of FMI"
    [ "$found" -eq "$FUNCTIONS" ]
}

# Solves one state with a library: LIBRARY, then the command that runs run_library there.
solve_with() {
    local library=$1 token load
    shift
    token=$(sed -nE 's/^  guid="(.*)"$/\1/p' modelDescription/fmi2.xml)
    load=$(sed -nE '/ScalarVariable name="load"/ s/.*valueReference="([0-9]+)".*/\1/p' modelDescription/fmi2.xml)
    "$@" "$library" "$token" "$load"
}

libraries=()
left_out=()

target=x86_64-unknown-linux-gnu
cargo zigbuild "${flags[@]}" --target "$target.$GLIBC"
python3 scripts/glibc.py "$built/$target/release/$library" "$GLIBC"
nm -D --defined-only "$built/$target/release/$library" | has_functions "$target"
python3 -m ziglang cc -target "x86_64-linux-gnu.$GLIBC" -O1 -o "$built/$target/run_library" scripts/run_library.c -ldl -lm
solve_with "$built/$target/release/$library" "$built/$target/run_library"
libraries+=(--library "$built/$target/release/$library")

target=x86_64-pc-windows-gnu
if ! command -v x86_64-w64-mingw32-gcc >/dev/null; then
    left_out+=("win64: no x86_64-w64-mingw32-gcc")
elif ! has_target "$target"; then
    left_out+=("win64: Rust has no standard library for $target here")
else
    cargo build "${flags[@]}" --target "$target"
    dll=$built/$target/release/cartilage_contact.dll
    x86_64-w64-mingw32-objdump -p "$dll" | has_functions "$target"
    if wine=$(command -v wine64 || command -v wine || ls /usr/lib/wine/wine64 2>/dev/null); then
        run=$built/$target/run
        mkdir -p "$run"
        x86_64-w64-mingw32-gcc -O1 -Wall -Werror -o "$run/run_library.exe" scripts/run_library.c
        x86_64-w64-mingw32-gcc -O1 -Wall -Werror -shared -o "$run/bcryptprimitives.dll" scripts/bcryptprimitives.c -ladvapi32
        WINEDEBUG=-all WINEPREFIX=$(realpath "$built")/wine solve_with "$dll" "$wine" "$run/run_library.exe"
    else
        left_out+=("a run of the win64 library: no wine")
    fi
    libraries+=(--library "$dll")
fi

target=aarch64-unknown-linux-gnu
if ! has_target "$target"; then
    left_out+=("aarch64: Rust has no standard library for $target here")
else
    cargo zigbuild "${flags[@]}" --target "$target.$GLIBC"
    python3 scripts/glibc.py "$built/$target/release/$library" "$GLIBC"
    nm -D --defined-only "$built/$target/release/$library" | has_functions "$target"
    if command -v qemu-aarch64 >/dev/null && [ -d /usr/aarch64-linux-gnu ]; then
        python3 -m ziglang cc -target "aarch64-linux-gnu.$GLIBC" -O1 -o "$built/$target/run_library" scripts/run_library.c -ldl -lm
        solve_with "$built/$target/release/$library" qemu-aarch64 -L /usr/aarch64-linux-gnu "$built/$target/run_library"
    else
        left_out+=("a run of the aarch64 library: no qemu-aarch64 with libc6-arm64-cross")
    fi
    libraries+=(--library "$built/$target/release/$library")
fi

cargo run --release --locked -- package "${libraries[@]}" --output "$output/CartilageLineContact.fmu"
for what in "${left_out[@]}"; do
    echo "left out: $what"
done
