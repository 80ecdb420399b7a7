#!/usr/bin/env bash
# Same bits everywhere for libtribo: the hashes of tests/golden/shapes.c, a test for each compiler,
# optimisation and architecture, against tests/golden/shapes.txt.
#
#   tests/golden_shapes.sh [--update|--write]
#       --update writes shapes.txt anew (gcc -O2) before comparing, --write does no more than that
#
# Where libccd and Qhull are, all of it runs with them; what needs neither runs bare everywhere.
set -u
cd "${SRCDIR:-$(dirname "$0")/..}" || exit 2
: "${BUILD:=$PWD/build}" "${CC:=gcc}"
golden=tests/golden/shapes.txt
work=$BUILD/golden-shapes
rm -rf "$work" && mkdir -p "$work/include" || exit 2
echo 'int main(void) { return 0; }' >"$work/nothing.c"
# shellcheck source=tests/golden/level.sh
. tests/golden/level.sh

# as in the Makefile
flags=(-std=c99 -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-tree-slp-vectorize)
flags+=(-Iinclude -Isrc "-I$work/include" -DTRIBO_BUILD)
sources=()
for name in math body broad clip closed collide convex mesh shape; do
    sources+=("src/$name.c")
done

# libccd's headers say the same for every target, whose own folders do not have them
header=$(echo '#include <ccd/ccd.h>' | gcc -M -x c - 2>/dev/null | grep -o '/[^ ]*/ccd/ccd\.h')
ln -s "${header%/ccd.h}" "$work/include/ccd"

# objects FOLDER COMPILER...: what programs of both kinds share is compiled once
objects()
{
    local folder=$1 source
    shift
    [ -e "$folder/done" ] && return
    mkdir -p "$folder"
    for source in "${sources[@]}"; do
        "$@" "${flags[@]}" -c "$source" -o "$folder/$(basename "$source" .c).o" || return 1
    done
    touch "$folder/done"
}

# build full|bare PROGRAM COMPILER...
build()
{
    local kind=$1 program=$2.$1 folder=$2.objects
    shift 2
    if "$@" -dM -E -x c /dev/null | grep -q __x86_64__; then
        set -- "$@" -mno-fma
    fi
    objects "$folder" "$@" || return 1
    if [ "$kind" = full ]; then
        "$@" "${flags[@]}" tests/golden/shapes.c src/hull.c "$folder"/*.o -lccd -lqhull_r -lm \
            -o "$program"
    else
        "$@" "${flags[@]}" -DTRIBO_GOLDEN_BARE tests/golden/shapes.c tests/golden/absent.c \
            "$folder"/*.o -lm -o "$program"
    fi
}

# expected full|bare: the lines of the golden that a program of that kind prints
expected()
{
    if [ "$1" = bare ]; then
        grep -E '^(shape|broad|closed|own) ' $golden
    elif [ "$(uname -m)" = x86_64 ]; then
        grep -vE '^own ' $golden
    else
        grep -E '^(shape|broad|closed) ' $golden
    fi
}

# judge KIND NAME "RUNNER" PROGRAM
judge()
{
    local kind=$1 name="$2, $1" runner=$3 program=$4 out
    out=$($runner "$program.$kind" 2>>"$program.log")
    # elsewhere libccd and Qhull are other builds: see shapes.c
    [ "$(uname -m)" = x86_64 ] || out=$(echo "$out" | grep -vE '^(libccd|hull) ')
    if [ "$out" = "$(expected "$kind")" ]; then
        echo "ok - $name"
    else
        echo "not ok - $name"
        echo "# differs in:" \
            "$(diff <(echo "$out") <(expected "$kind") | grep '^<' | tr -s '\n' ' ')"
        sed 's/^/# /' "$program.log"
    fi
}

# cell "KIND..." NAME "RUNNER" COMPILER...
cell()
{
    local kinds=$1 name=$2 runner=$3 program=$work/${2//[^a-zA-Z0-9]/-} kind
    shift 3
    for kind in $kinds; do
        if ! { "$@" "$work/nothing.c" -o "$program.nothing" && $runner "$program.nothing"; } \
            >"$program.log" 2>&1; then
            echo "ok - $name, $kind # SKIP cannot build or run a program:" \
                "$(head -n 1 "$program.log")"
        elif ! build "$kind" "$program" "$@" >"$program.log" 2>&1; then
            echo "not ok - $name, $kind"
            grep -m 5 -E 'error|undefined' "$program.log" | sed 's/^/# /'
        else
            judge "$kind" "$name" "$runner" "$program"
        fi
    done
}

built_library()
{
    local program=$work/built
    # shellcheck disable=SC2086 # the flags are words
    if $CC ${CFLAGS:-} "${flags[@]}" tests/golden/shapes.c ${LDFLAGS:-} "$BUILD/libtribo.so" \
        "$BUILD/libtribo_core.so" -Wl,-rpath,"$BUILD" -lm -o "$program" 2>"$program.log" &&
        [ "$("$program")" = "$(expected full)" ]; then
        echo "ok - built library"
    else
        echo "not ok - built library"
        head -n 5 "$program.log" | sed 's/^/# /'
    fi
}

# Hashes see only what the run meets; the absence of fused multiply-adds can be seen in the code.
nothing_fused()
{
    local found
    found=$(objdump -d --no-show-raw-insn "$BUILD/libtribo.so" |
        grep -E '\s(vfn?m(add|sub)|fn?m(add|sub)|fml[as])' | head -n 5)
    if ! objdump -d "$BUILD/libtribo.so" | grep -q '<convex_axis'; then
        echo "not ok - no fused multiply-add in the library"
        echo "# there is no code to look at"
    elif [ -n "$found" ]; then
        echo "not ok - no fused multiply-add in the library"
        echo "# $found"
    else
        echo "ok - no fused multiply-add in the library"
    fi
}

# Two cells at a time; what each prints is kept apart and put in order at the end.
cells=0
start()
{
    while [ "$(jobs -rp | wc -l)" -ge 2 ]; do
        wait -n
    done
    cells=$((cells + 1))
    "$@" >"$work/$(printf '%03d' $cells).out" &
}

machine=$(uname -m)
runner_i686=qemu-i386
[ "$machine" = x86_64 ] && runner_i686=
runner_aarch64=qemu-aarch64
[ "$machine" = aarch64 ] && runner_aarch64=
wasm=(clang-16 --target=wasm32-wasi --sysroot=/usr)
# node before 20 wants the flag, later ones accept it
wasi="node --no-warnings --experimental-wasi-unstable-preview1 tests/golden/wasi.mjs"

if [ "${1:-}" = --update ] || [ "${1:-}" = --write ]; then
    build full "$work/update" gcc -O2 && build bare "$work/update" gcc -O2 &&
        { "$work/update.bare" && "$work/update.full" | grep -vE '^(shape|broad|closed) '; } >$golden ||
        exit 1
    cat $golden
    [ "$1" = --update ] || exit 0
fi

start built_library
start nothing_fused
start cell bare "aarch64 gcc -O2" "$runner_aarch64" aarch64-linux-gnu-gcc -static -O2
start cell bare "wasm32 clang -O2" "$wasi" "${wasm[@]}" -O2
start cell bare "i686 gcc -O2 SSE2" "$runner_i686" \
    i686-linux-gnu-gcc -static -O2 -msse2 -mfpmath=sse
for compiler in gcc clang-16; do
    for optimisation in -O0 -O2 -O3; do
        start cell "full bare" "$compiler $optimisation" "" $compiler $optimisation
    done
done
if [ "$machine" = x86_64 ]; then
    # the whole library for a machine with FMA, as -march=native would make it
    for compiler in gcc clang-16; do
        for level in x86-64-v3 x86-64-v4; do
            name="$compiler -O3 all $level"
            if has_level $level; then
                start cell full "$name" "" $compiler -O3 -march=$level
            else
                start echo "ok - $name, full # SKIP this processor has no $level"
            fi
        done
    done
fi
wait

cat "$work"/*.out | awk '
    /^ok / { sub(/^ok/, "ok " ++n) }
    /^not ok / { sub(/^not ok/, "not ok " ++n); failed = 1 }
    { print }
    END { print "1.." n; exit failed }'
