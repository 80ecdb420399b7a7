#!/usr/bin/env bash
# Same bits everywhere: the hashes of tests/golden/bits.c, one test for each compiler, optimisation,
# instruction set and architecture, against tests/golden/bits.txt; and the same layout of structs.
#
#   tests/golden.sh [--update]      --update writes bits.txt anew (gcc -O2, scalar) before comparing,
#                                   and shapes.txt of golden_shapes.sh
#
# The sources are compiled here and not by the Makefile: what is under test is the source, under any
# flags. The library as it was built is the first cell.
set -u
cd "${SRCDIR:-$(dirname "$0")/..}" || exit 2
: "${BUILD:=$PWD/build}" "${CC:=gcc}"
golden=tests/golden/bits.txt
work=$BUILD/golden
rm -rf "$work" && mkdir -p "$work" || exit 2

# as in the Makefile
flags=(-std=c99 -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-tree-slp-vectorize)
flags+=(-Iinclude -DTRIBO_BUILD)
sources=()
# libtribo_core alone: what needs other libraries cannot be built for every target
full=" $(sed -n '/^FULL := /{:a;/\\$/{N;s/\\\n//;ba};s/^FULL := //p}' Makefile) "
for source in src/*.c; do
    [[ $source == *_lanes.c || $full == *" $(basename "$source" .c) "* ]] || sources+=("$source")
done
echo 'int main(void) { return 0; }' >"$work/nothing.c"
# shellcheck source=tests/golden/level.sh
. tests/golden/level.sh

# build PROGRAM COMPILER...: lanes for every level of x86-64 where the compiler makes x86-64 code.
build()
{
    local program=$1 level source levels=(baseline) objects=() define=()
    shift
    if "$@" -dM -E -x c /dev/null | grep -q __x86_64__; then
        levels+=(x86_64_v3 x86_64_v4)
        define=(-DTRIBO_HAVE_X86_64_LEVELS=1)
        set -- "$@" -mno-fma
    fi
    for level in "${levels[@]}"; do
        local march=()
        case $level in
        x86_64_v3) march=(-march=x86-64-v3) ;;
        x86_64_v4) march=(-march=x86-64-v4 -mprefer-vector-width=512) ;;
        esac
        for source in src/*_lanes.c; do
            local object=$program.$(basename "$source" .c).$level.o
            objects+=("$object")
            "$@" "${march[@]}" "${flags[@]}" "-DTRIBO_LANES=$level" -c "$source" -o "$object" ||
                return 1
        done
    done
    "$@" "${flags[@]}" "${define[@]}" "${sources[@]}" tests/golden/bits.c "${objects[@]}" -lm \
        -o "$program"
}

# compare NAME "ISA..." COMMAND...
compare()
{
    local name=$1 isas=$2 isa out status errors=$work/${1//[^a-zA-Z0-9]/-}.errors
    shift 2
    for isa in $isas; do
        out=$(TRIBO_ISA=$isa "$@" 2>"$errors")
        status=$?
        if [ $status -eq 77 ]; then
            echo "ok - $name, $isa # SKIP this machine has no $isa"
        elif [ $status -eq 0 ] && [ "$out" = "$(cat $golden)" ]; then
            echo "ok - $name, $isa"
        else
            echo "not ok - $name, $isa"
            echo "# exit status $status; differs in:" \
                "$(diff <(echo "$out") $golden | grep '^<' | tr -s '\n' ' ')"
            sed 's/^/# /' "$errors"
        fi
    done
}

# layout NAME "RUNNER" PROGRAM COMPILER...
layout()
{
    local name=$1 runner=$2 program=$3
    shift 3
    "$@" "${flags[@]}" tests/abi/layout.c -o "$program.layout" 2>"$program.log"
    if diff <($runner "$program.layout") tests/abi/layout.txt >>"$program.log"; then
        echo "ok - $name, layout of structs"
    else
        echo "not ok - $name, layout of structs"
        sed 's/^/# /' "$program.log"
    fi
}

# cell NAME "ISA..." "RUNNER" COMPILER...
cell()
{
    local name=$1 isas=$2 runner=$3 program=$work/${1//[^a-zA-Z0-9]/-} isa
    shift 3
    if ! { "$@" "$work/nothing.c" -o "$program.nothing" && $runner "$program.nothing"; } \
        >"$program.log" 2>&1; then
        for isa in $isas; do
            echo "ok - $name, $isa # SKIP cannot build or run a program:" \
                "$(head -n 1 "$program.log")"
        done
    elif [[ $isas == x86-64-v? ]] && ! has_level "$isas"; then # nothing of it could be run
        echo "ok - $name, $isas # SKIP this processor has no $isas"
        layout "$name" "$runner" "$program" "$@"
    elif ! build "$program" "$@" >"$program.log" 2>&1; then
        for isa in $isas; do
            echo "not ok - $name, $isa"
        done
        grep -m 5 -E 'error|undefined' "$program.log" | sed 's/^/# /'
    else
        compare "$name" "$isas" $runner "$program"
        layout "$name" "$runner" "$program" "$@"
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

built_library()
{
    local program=$work/built
    # shellcheck disable=SC2086 # the flags are words
    if $CC ${CFLAGS:-} "${flags[@]}" tests/golden/bits.c ${LDFLAGS:-} "$BUILD/libtribo_core.a" \
        -lm -o "$program" 2>"$program.log"; then
        compare "built library" "best scalar" "$program"
    else
        echo "not ok - built library"
        head -n 5 "$program.log" | sed 's/^/# /'
    fi
}

# Hashes see only what the run meets; the absence of fused multiply-adds can be seen in the code.
nothing_fused()
{
    local found
    found=$(objdump -d --no-show-raw-insn "$BUILD/libtribo_core.so" |
        grep -E '\s(vfn?m(add|sub)|fn?m(add|sub)|fml[as])' | head -n 5)
    if ! objdump -d "$BUILD/libtribo_core.so" | grep -q '<tribo_vec3_dot'; then
        echo "not ok - no fused multiply-add in the library"
        echo "# there is no code to look at"
    elif [ -n "$found" ]; then
        echo "not ok - no fused multiply-add in the library"
        echo "# $found"
    else
        echo "ok - no fused multiply-add in the library"
    fi
}

machine=$(uname -m)
native="scalar baseline"
[ "$machine" = x86_64 ] && native="scalar baseline x86-64-v3 x86-64-v4 best"
runner_i686=qemu-i386
[ "$machine" = x86_64 ] && runner_i686=
runner_aarch64=qemu-aarch64
[ "$machine" = aarch64 ] && runner_aarch64=
wasm=(clang-16 --target=wasm32-wasi --sysroot=/usr)
# node before 20 wants the flag, later ones accept it
wasi="node --no-warnings --experimental-wasi-unstable-preview1 tests/golden/wasi.mjs"

if [ "${1:-}" = --update ]; then
    build "$work/update" gcc -O2 && TRIBO_ISA=scalar "$work/update" >"$golden" || exit 1
    cat $golden
    tests/golden_shapes.sh --write || exit 1
fi

start built_library
start nothing_fused
start cell "aarch64 gcc -O2" "scalar baseline" "$runner_aarch64" aarch64-linux-gnu-gcc -static -O2
start cell "wasm32 clang -O2" "scalar baseline" "$wasi" "${wasm[@]}" -O2
start cell "wasm32 clang -O2 simd128" "scalar baseline" "$wasi" "${wasm[@]}" -O2 -msimd128
start cell "i686 gcc -O2 SSE2" "scalar baseline" "$runner_i686" \
    i686-linux-gnu-gcc -static -O2 -msse2 -mfpmath=sse
for compiler in gcc clang-16; do
    for optimisation in -O0 -O2 -O3; do
        start cell "$compiler $optimisation" "$native" "" $compiler $optimisation
    done
done
if [ "$machine" = x86_64 ]; then
    # the whole library for a machine with FMA, as -march=native would make it
    for compiler in gcc clang-16; do
        for level in x86-64-v3 x86-64-v4; do
            start cell "$compiler -O3 all $level" "$level" "" $compiler -O3 -march=$level
        done
    done
fi
wait

cat "$work"/*.out | awk '
    /^ok / { sub(/^ok/, "ok " ++n) }
    /^not ok / { sub(/^not ok/, "not ok " ++n); failed = 1 }
    { print }
    END { print "1.." n; exit failed }'
