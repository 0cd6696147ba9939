#!/usr/bin/env bash
# Builds what a release consists of, into target/release-files (or below CARGO_TARGET_DIR): the FMUs with the libraries of as many
# platforms as this machine can make, a wheel a platform, checksums, and the section of the changelog. Checks each library, runs it
# where there is something to run it with, and says what was left out.
#
#   bash scripts/release.sh [PLATFORM...]    linux64 aarch64-linux win64 darwin; all by default
#
# Everything is linked by zig (from PyPI). Rust's standard library for each target comes from rustup.
#   linux64, aarch64-linux  need glibc 2.17 (2012) and nothing else; aarch64 is run if there are qemu-aarch64 and libc6-arm64-cross
#   win64                   is run if there is a wine and a mingw-w64
#   darwin                  one file for Intel and ARM; needs macOS 11
set -eu
cd "$(dirname "$0")/.."

GLIBC=2.17
ZIG=0.17.1
CARGO_ZIGBUILD=0.24.0
FUNCTIONS=109 # 34 of FMI 2.0 co-simulation, 75 of FMI 3.0
built=${CARGO_TARGET_DIR:-target}
tools=$built/release-tools
output=$built/release-files
wanted=" ${*:-linux64 aarch64-linux win64 darwin} "
version=$(sed -nE 's/^version = "(.*)"$/\1/p' Cargo.toml | head -n 1)

if ! "$tools/bin/cargo-zigbuild" --version 2>/dev/null | grep -q "$CARGO_ZIGBUILD"; then
    python3 -m venv --clear "$tools"
    "$tools/bin/python" -m pip install --quiet "ziglang==$ZIG" "cargo-zigbuild==$CARGO_ZIGBUILD"
fi
export PATH="$(realpath "$tools")/bin:$PATH"
rm -rf "$output"
mkdir -p "$output"

# Whether a platform is wanted and Rust's standard library for its targets is there or to be had.
can_build() {
    local platform=$1 target
    shift
    [[ $wanted == *" $platform "* ]] || return 1
    for target in "$@"; do
        if ! [ -d "$(rustc --print sysroot)/lib/rustlib/$target/lib" ] && ! timeout 300 rustup target add "$target" >/dev/null 2>&1; then
            left_out+=("$platform: Rust has no standard library for $target here")
            return 1
        fi
    done
}

# The library first, without what only the program needs; then the program.
build() {
    cargo zigbuild --release --locked --lib --no-default-features --target "$1"
    cp "$2/$3" "$2/library-of-the-fmu"
    cargo zigbuild --release --locked --bin cartilage-contact --target "$1"
    cp "$2/library-of-the-fmu" "$2/$3"
}

# Whether a table of symbols has all functions of both standards.
has_functions() {
    local found
    found=$(grep -oE '\bfmi[23][A-Z][A-Za-z0-9]+' | sort -u | wc -l || true)
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
platforms=() # tag of the wheel, folder, program, library
left_out=()

linux() {
    local target=$1 tag=$2 folder=$built/$1/release library=libcartilage_contact.so
    build "$target.$GLIBC" "$folder" "$library"
    python3 scripts/glibc.py "$folder/$library" "$GLIBC"
    nm -D --defined-only "$folder/$library" | has_functions "$target"
    python3 -m ziglang cc -target "${target/-unknown/}.$GLIBC" -O1 -o "$built/$target/run_library" scripts/run_library.c -ldl -lm
    libraries+=(--library "$folder/$library")
    platforms+=("manylinux2014_$tag $folder cartilage-contact $library")
}

target=x86_64-unknown-linux-gnu
if can_build linux64 $target; then
    linux $target x86_64
    solve_with "$built/$target/release/libcartilage_contact.so" "$built/$target/run_library"
fi

target=aarch64-unknown-linux-gnu
if can_build aarch64-linux $target; then
    linux $target aarch64
    if command -v qemu-aarch64 >/dev/null && [ -d /usr/aarch64-linux-gnu ]; then
        solve_with "$built/$target/release/libcartilage_contact.so" qemu-aarch64 -L /usr/aarch64-linux-gnu "$built/$target/run_library"
    else
        left_out+=("a run of the aarch64-linux library: no qemu-aarch64 with libc6-arm64-cross")
    fi
fi

target=x86_64-pc-windows-gnu
if can_build win64 $target; then
    folder=$built/$target/release
    build "$target" "$folder" cartilage_contact.dll
    objdump -p "$folder/cartilage_contact.dll" | has_functions "$target"
    if wine=$(command -v wine64 || command -v wine || ls /usr/lib/wine/wine64 2>/dev/null) && command -v x86_64-w64-mingw32-gcc >/dev/null; then
        run=$built/$target/run
        mkdir -p "$run"
        x86_64-w64-mingw32-gcc -O1 -Wall -Werror -o "$run/run_library.exe" scripts/run_library.c
        x86_64-w64-mingw32-gcc -O1 -Wall -Werror -shared -o "$run/bcryptprimitives.dll" scripts/bcryptprimitives.c -ladvapi32
        WINEDEBUG=-all WINEPREFIX=$(realpath "$built")/wine solve_with "$folder/cartilage_contact.dll" "$wine" "$run/run_library.exe"
    else
        left_out+=("a run of the win64 library: no wine with mingw-w64")
    fi
    libraries+=(--library "$folder/cartilage_contact.dll")
    platforms+=("win_amd64 $folder cartilage-contact.exe cartilage_contact.dll")
fi

target=universal2-apple-darwin
if can_build darwin x86_64-apple-darwin aarch64-apple-darwin; then
    folder=$built/$target/release
    MACOSX_DEPLOYMENT_TARGET=11.0 build "$target" "$folder" libcartilage_contact.dylib
    # Both halves have to have them; the names are text in each.
    strings -n 8 "$folder/libcartilage_contact.dylib" | sed 's/^_//' | has_functions "$target"
    left_out+=("a run of the darwin library: this is no macOS")
    libraries+=(--library "$folder/libcartilage_contact.dylib")
    platforms+=("macosx_11_0_universal2 $folder cartilage-contact libcartilage_contact.dylib")
fi

cargo run --release --locked -- package "${libraries[@]}" --output "$output/CartilageLineContact.fmu"
for platform in "${platforms[@]}"; do
    read -r tag folder program library <<<"$platform"
    native=$built/release-native
    rm -rf "$native"
    mkdir -p "$native"
    cp "$folder/$program" "$folder/$library" "$native"
    # Of this platform alone: on ARM Linux, FMPy looks where Intel's library is in the FMU of all.
    "$built/release/cartilage-contact" package --library "$folder/$library" --output "$native/CartilageLineContact.fmu"
    rm -rf "$built/python"
    CARTILAGE_CONTACT_BUILT=$(realpath "$native") python3 -m pip wheel --quiet --no-deps --wheel-dir "$output" \
        --config-settings="--build-option=--plat-name=$tag" .
done
# Everything since the last release; at a release its section carries the version.
awk -v version="$version" '/^## \[/ { if (found) exit; found = $0 ~ "Unreleased" || index($0, version) } found' CHANGELOG.md >"$output/CHANGES.md"
(cd "$output" && sha256sum -- *.fmu *.whl >SHA256SUMS)
ls -l "$output"
for what in "${left_out[@]}"; do
    echo "left out: $what"
done
