#!/usr/bin/env bash
# The binary interface against its goldens in tests/abi: symbols, layouts, and types as abidw sees
# them.
#
#   tests/abi.sh [--update]      --update writes the goldens anew; do so only with a reason, in the
#                                same commit as the change and its line in CHANGELOG.md
#
# Any difference fails. abidiff calls most breaks of a C interface (a reordered field, a float in
# place of a double) merely "changed", so every exit status but 0 fails, and nothing is suppressed.
set -u
cd "${SRCDIR:-$(dirname "$0")/..}" || exit 2
export LC_ALL=C
: "${BUILD:=$PWD/build}" "${CC:=gcc}"
library=$(readlink -f "$BUILD/libtribo_core.so")
full=$(readlink -f "$BUILD/libtribo.so")
work=$BUILD/abi
mkdir -p "$work" || exit 2

echo 1..8
number=0 failures=0
check() # NAME COMMAND...; what the command prints is shown if it fails
{
    local name=$1 out
    shift
    number=$((number + 1))
    if out=$("$@" 2>&1); then
        echo "ok $number - $name"
    else
        echo "not ok $number - $name"
        echo "$out" | head -n 60 | sed 's/^/# /'
        failures=$((failures + 1))
    fi
}
skip()
{
    number=$((number + 1))
    echo "ok $number - $1 # SKIP $2"
}

exported()
{
    nm -D --defined-only "$library" "$full" | awk 'NF == 3 { print $2, $3 }' | sort
}

# What the compiler sees of the headers, without comments, one declaration after the other.
declarations()
{
    cat include/tribo/*.h | "$CC" -w -fpreprocessed -dD -E -P -x c - | grep -v '^#'
}

# Functions marked TRIBO_API: the last name before the first parenthesis that follows.
declared_functions()
{
    declarations | tr '\n' ' ' | sed 's/TRIBO_API/\n&/g' |
        sed -n 's/^TRIBO_API[^(]*[ *]\(tribo_[a-z0-9_]*\) *(.*/T \1/p' | sort
}

# Every struct, its fields and every enumerator, as layout.txt names them.
declared_names()
{
    declarations | awk '
        /typedef struct tribo_.*\{/ { inside = 1; count = 0; next }
        inside && /^ *} *tribo_/ {
            sub(/^ *} */, ""); sub(/;.*/, "")
            print $0
            for (i = 0; i < count; i++) print $0 "." field[i]
            inside = 0
            next
        }
        inside && /;/ { sub(/(\[.*)?;.*/, ""); sub(/.*[ *]/, ""); field[count++] = $0; next }
        match($0, /TRIBO_[A-Z0-9_]+ = /) { print substr($0, RSTART, RLENGTH - 3) }' | sort
}

named_in_layout()
{
    awk '{ print $1 }' tests/abi/layout.txt tests/abi/layout_tribo.txt | grep -vx -e tribo_status -e TRIBO_WORLD | sort
}

layout()
{
    "$CC" -std=c99 -Iinclude tests/abi/layout.c -o "$work/layout" && "$work/layout"
}

# Structs that hold pointers: this golden is for machines of 64 bits.
layout_tribo()
{
    "$CC" -std=c99 -Iinclude tests/abi/layout_tribo.c -o "$work/layout_tribo" &&
        "$work/layout_tribo"
}

# abidw reads debug information; a library without it would compare equal to anything.
with_debug_info()
{
    if ! readelf -S "$library" | grep -q '\.debug_info'; then
        MAKEFLAGS='' make -s lib BUILD="$work/build" CC=gcc CFLAGS='-O2 -g' LDFLAGS='' CPPFLAGS='' \
            >&2 || return 1
        library=$(readlink -f "$work/build/libtribo_core.so")
        full=$(readlink -f "$work/build/libtribo.so")
    fi
    readelf -S "$library" | grep -q '\.debug_info'
}

types() # FILE LIBRARY
{
    abidw --headers-dir include --exported-interfaces-only --drop-private-types --no-show-locs \
        --no-comp-dir-path --no-corpus-path --no-elf-needed --out-file "$1" "$2"
}

# abidw keeps the paths of the sources as the compiler was given them: relative ones.
no_machine_path()
{
    ! grep -nE "(path|name|comp-dir-path)='/" tests/abi/tribo_core.abi tests/abi/tribo.abi
}

same_types()
{
    # A short baseline would say that nothing was read.
    local names
    names=$(cat tests/abi/tribo_core.abi tests/abi/tribo.abi |
        grep -o "<elf-symbol name='tribo_[a-z0-9_]*'\|<function-decl name='tribo_[a-z0-9_]*'[^>]*elf-symbol-id" |
        grep -o "name='[a-z0-9_]*" | sort -u | wc -l)
    [ "$names" -eq "$(wc -l <tests/abi/symbols.txt)" ] &&
        types "$work/tribo_core.abi" "$library" &&
        abidiff tests/abi/tribo_core.abi "$work/tribo_core.abi" &&
        types "$work/tribo.abi" "$full" && abidiff tests/abi/tribo.abi "$work/tribo.abi"
}

same()
{
    diff -u "$1" <("$2")
}

equal()
{
    diff -u --label "$1" --label "$2" <("$1") <("$2")
}

if [ "${1:-}" = --update ]; then
    exported >tests/abi/symbols.txt
    layout >tests/abi/layout.txt && layout_tribo >tests/abi/layout_tribo.txt || exit 1
    with_debug_info && types tests/abi/tribo_core.abi "$library" &&
        types tests/abi/tribo.abi "$full" || exit 1
fi

check "symbols are those of symbols.txt" same tests/abi/symbols.txt exported
check "exactly the functions that headers declare are exported" equal declared_functions exported
check "layouts and constants are those of layout.txt" same tests/abi/layout.txt layout
check "layouts of libtribo are those of layout_tribo.txt" same tests/abi/layout_tribo.txt layout_tribo
check "no struct, field or constant is missing in layout.txt" equal declared_names named_in_layout
if command -v abidw >/dev/null && command -v abidiff >/dev/null; then
    check "the library has debug information to compare" with_debug_info
    with_debug_info
    check "types are those of tribo_core.abi" same_types
else
    skip "the library has debug information to compare" "abidw is not installed"
    skip "types are those of tribo_core.abi" "abidw is not installed"
fi
check "tribo_core.abi names no path of a machine" no_machine_path
exit $((failures > 0))
