#!/usr/bin/env bash
# Builds the FMUs for as many platforms as this machine has the tools for, into target/fmu/release, and says which were
# left out.
#
#   linux64  always: linked by zig (from PyPI), so that any Linux with glibc 2.17 or newer (2012) can load it
#   win64    with mingw-w64 (x86_64-w64-mingw32-gcc) and Rust's target x86_64-pc-windows-gnu
#   aarch64  with Rust's target aarch64-unknown-linux-gnu; linked by zig; FMI 3.0 only, FMI 2.0 has no name for it
set -eu
cd "$(dirname "$0")/.."

GLIBC=2.17
ZIG=0.17.1
CARGO_ZIGBUILD=0.24.0
tools=target/release-tools
output=target/fmu/release
flags=(--release --lib --no-default-features --locked)
library=libcartilage_contact.so

if ! "$tools/bin/cargo-zigbuild" --version 2>/dev/null | grep -q "$CARGO_ZIGBUILD"; then
    python3 -m venv --clear "$tools"
    "$tools/bin/python" -m pip install --quiet "ziglang==$ZIG" "cargo-zigbuild==$CARGO_ZIGBUILD"
fi
export PATH="$PWD/$tools/bin:$PATH"

# Rust's standard library for a target: installed, or to be had from rustup.
has_target() {
    [ -d "$(rustc --print sysroot)/lib/rustlib/$1/lib" ] || timeout 60 rustup target add "$1" >/dev/null 2>&1
}

libraries=()
left_out=()

target=x86_64-unknown-linux-gnu
cargo zigbuild "${flags[@]}" --target "$target.$GLIBC"
python3 scripts/glibc.py "target/$target/release/$library" "$GLIBC"
libraries+=(--library "target/$target/release/$library")

target=x86_64-pc-windows-gnu
if ! command -v x86_64-w64-mingw32-gcc >/dev/null; then
    left_out+=("win64: no x86_64-w64-mingw32-gcc")
elif ! has_target "$target"; then
    left_out+=("win64: Rust has no standard library for $target here")
else
    cargo build "${flags[@]}" --target "$target"
    libraries+=(--library "target/$target/release/cartilage_contact.dll")
fi

target=aarch64-unknown-linux-gnu
if ! has_target "$target"; then
    left_out+=("aarch64: Rust has no standard library for $target here")
else
    cargo zigbuild "${flags[@]}" --target "$target.$GLIBC"
    libraries+=(--library "target/$target/release/$library")
fi

cargo run --release --locked -- package "${libraries[@]}" --output "$output/CartilageLineContact.fmu"
for platform in "${left_out[@]}"; do
    echo "left out: $platform"
done
