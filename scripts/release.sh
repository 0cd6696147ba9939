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
FUNCTIONS=119 # 44 of FMI 2.0 (10 of them refuse: those of model exchange), 75 of FMI 3.0
LARGEST=6000000 # bytes of a library for one processor
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

# The library, without what only the program needs, in a folder of its own: TARGET, FILE. Building the program writes over the other.
# For Windows and macOS it is optimised as a whole, so that Rust leaves out what nothing calls. On Linux the linker does that; there it
# cannot, because all functions are exported (cargo-zigbuild or zig drops Rust's list of exports), and on Windows they share sections too.
build_library() {
    local target=${1%.2.*} size name=()
    if [[ $target == *linux* ]]; then
        cargo zigbuild --release --locked --lib --no-default-features --target "$1"
    else
        # Without a name of its own a library of macOS carries the path where it was linked.
        if [[ $target == *darwin* ]]; then name=(-- -C link-arg=-Wl,-install_name,@rpath/CartilageLineContact.dylib); fi
        CARGO_PROFILE_RELEASE_LTO=fat cargo-zigbuild rustc --release --locked --lib --crate-type cdylib --no-default-features \
            --target "$1" "${name[@]}"
    fi
    mkdir -p "$built/release-libraries/$target"
    library=$built/release-libraries/$target/$2
    cp "$built/$target/release/$2" "$library"
    size=$(wc -c <"$library")
    echo "$target: $size bytes"
    [ "$size" -le "$LARGEST" ]
    if grep -qaF "$(realpath "$built")" "$library"; then
        echo "$library names the folder in which it was built"
        return 1
    fi
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
platforms=() # tag of the wheel, target, folder, program, library
left_out=()

linux() {
    local target=$1 tag=$2
    build_library "$target.$GLIBC" libcartilage_contact.so
    python3 scripts/glibc.py "$library" "$GLIBC"
    nm -D --defined-only "$library" | has_functions "$target"
    python3 -m ziglang cc -target "${target/-unknown/}.$GLIBC" -O1 -o "$built/$target/run_library" scripts/run_library.c -ldl -lm
    libraries+=(--library "$library")
    platforms+=("manylinux2014_$tag $target.$GLIBC $built/$target/release cartilage-contact $library")
}

target=x86_64-unknown-linux-gnu
if can_build linux64 $target; then
    linux $target x86_64
    solve_with "$library" "$built/$target/run_library"
fi

target=aarch64-unknown-linux-gnu
if can_build aarch64-linux $target; then
    linux $target aarch64
    if command -v qemu-aarch64 >/dev/null && [ -d /usr/aarch64-linux-gnu ]; then
        solve_with "$library" qemu-aarch64 -L /usr/aarch64-linux-gnu "$built/$target/run_library"
    else
        left_out+=("a run of the aarch64-linux library: no qemu-aarch64 with libc6-arm64-cross")
    fi
fi

target=x86_64-pc-windows-gnu
if can_build win64 $target; then
    build_library "$target" cartilage_contact.dll
    objdump -p "$library" | has_functions "$target"
    if wine=$(command -v wine64 || command -v wine || ls /usr/lib/wine/wine64 2>/dev/null) && command -v x86_64-w64-mingw32-gcc >/dev/null; then
        run=$built/$target/run
        mkdir -p "$run"
        x86_64-w64-mingw32-gcc -O1 -Wall -Werror -o "$run/run_library.exe" scripts/run_library.c
        x86_64-w64-mingw32-gcc -O1 -Wall -Werror -shared -o "$run/bcryptprimitives.dll" scripts/bcryptprimitives.c -ladvapi32
        WINEDEBUG=-all WINEPREFIX=$(realpath "$built")/wine solve_with "$library" "$wine" "$run/run_library.exe"
    else
        left_out+=("a run of the win64 library: no wine with mingw-w64")
    fi
    libraries+=(--library "$library")
    platforms+=("win_amd64 $target $built/$target/release cartilage-contact.exe $library")
fi

target=universal2-apple-darwin
if can_build darwin x86_64-apple-darwin aarch64-apple-darwin; then
    export MACOSX_DEPLOYMENT_TARGET=11.0
    halves=()
    for half in x86_64 aarch64; do
        build_library "$half-apple-darwin" libcartilage_contact.dylib
        halves+=("$library")
    done
    mkdir -p "$built/release-libraries/$target"
    library=$built/release-libraries/$target/libcartilage_contact.dylib
    python3 scripts/universal.py "$library" "${halves[@]}"
    # Both halves have to have them: their symbols are text with an underscore in front, once a half.
    strings -n 8 "$library" | grep -xE '_fmi[23][A-Z][A-Za-z0-9]+' | sort | uniq -d | sed 's/^_//' | has_functions "$target"
    left_out+=("a run of the darwin library: this is no macOS")
    libraries+=(--library "$library")
    platforms+=("macosx_11_0_universal2 $target $built/$target/release cartilage-contact $library")
fi

cargo run --release --locked -- package "${libraries[@]}" --output "$output/CartilageLineContact.fmu"
for platform in "${platforms[@]}"; do
    read -r tag target folder program library <<<"$platform"
    # As the library of that platform, and for the same reasons.
    if [[ $target == *linux* ]]; then lto=false; else lto=fat; fi
    CARGO_PROFILE_RELEASE_LTO=$lto cargo zigbuild --release --locked --bin cartilage-contact --target "$target"
    native=$built/release-native
    rm -rf "$native"
    mkdir -p "$native"
    cp "$folder/$program" "$library" "$native"
    # Of this platform alone: on ARM Linux, FMPy looks where Intel's library is in the FMU of all.
    "$built/release/cartilage-contact" package --library "$library" --output "$native/CartilageLineContact.fmu"
    # Where setup.py gathers the files: those of the platform before would go into this wheel too.
    rm -rf target/python
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
