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
work=$BUILD/abi
mkdir -p "$work" || exit 2

echo 1..7
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
    nm -D --defined-only "$library" | awk '{ print $2, $3 }' | sort
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
        /typedef struct tribo_/ { inside = 1; count = 0; next }
        inside && /^ *} *tribo_/ {
            sub(/^ *} */, ""); sub(/;.*/, "")
            print $0
            for (i = 0; i < count; i++) print $0 "." field[i]
            inside = 0
            next
        }
        inside && /;/ { sub(/(\[.*)?;.*/, ""); field[count++] = $NF; next }
        match($0, /TRIBO_[A-Z0-9_]+ = /) { print substr($0, RSTART, RLENGTH - 3) }' | sort
}

named_in_layout()
{
    awk '{ print $1 }' tests/abi/layout.txt | grep -vx -e tribo_status -e TRIBO_WORLD | sort
}

layout()
{
    "$CC" -std=c99 -Iinclude tests/abi/layout.c -o "$work/layout" && "$work/layout"
}

# abidw reads debug information; a library without it would compare equal to anything.
with_debug_info()
{
    if ! readelf -S "$library" | grep -q '\.debug_info'; then
        MAKEFLAGS='' make -s lib BUILD="$work/build" CC=gcc CFLAGS='-O2 -g' LDFLAGS='' CPPFLAGS='' \
            >&2 || return 1
        library=$(readlink -f "$work/build/libtribo_core.so")
    fi
    readelf -S "$library" | grep -q '\.debug_info'
}

types()
{
    abidw --headers-dir include --drop-private-types --no-show-locs --no-comp-dir-path \
        --no-corpus-path --no-elf-needed --out-file "$1" "$library"
}

# abidw keeps the paths of the sources as the compiler was given them: relative ones.
no_machine_path()
{
    ! grep -nE "(path|name|comp-dir-path)='/" tests/abi/tribo_core.abi
}

same_types()
{
    # A short baseline would say that nothing was read.
    [ "$(grep -c "<function-decl name='tribo_" tests/abi/tribo_core.abi)" -eq \
        "$(wc -l <tests/abi/symbols.txt)" ] &&
        types "$work/tribo_core.abi" && abidiff tests/abi/tribo_core.abi "$work/tribo_core.abi"
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
    layout >tests/abi/layout.txt
    with_debug_info && types tests/abi/tribo_core.abi || exit 1
fi

check "symbols are those of symbols.txt" same tests/abi/symbols.txt exported
check "exactly the functions that headers declare are exported" equal declared_functions exported
check "layouts and constants are those of layout.txt" same tests/abi/layout.txt layout
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
