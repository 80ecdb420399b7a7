#!/bin/sh
# The table "function, target" in fuzz/README.md: complete, without strangers, and true; and the
# corpora: small, their files named by content. TAP.
set -u
SRCDIR=${SRCDIR:-.}
BUILD=${BUILD:-$SRCDIR/build}
LC_ALL=C
export LC_ALL
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
number=0

# report NAME FILE: ok if FILE, the list of what is wrong, is empty
report()
{
    number=$((number + 1))
    if [ -s "$2" ]; then
        echo "not ok $number - $1"
        sed 's/^/# /' "$2"
    else
        echo "ok $number - $1"
    fi
}

# without comments, so that a name in prose is not taken for a call
code()
{
    sed -e 's|/\*.*\*/||' -e '/\/\*/,/\*\//d' "$1"
}

echo 1..7
# exported LIBRARY: the functions of a library
exported()
{
    nm -D --defined-only "$BUILD/$1.so" 2>>"$work/errors" |
        awk '{ sub(/@.*/, "", $3); print $3 }' | grep '^tribo_' | sort -u
}
exported libtribo_core >"$work/core"
exported libtribo >"$work/full"
sort -u "$work/core" "$work/full" >"$work/exported"
sed -n 's/^| `\(tribo_[a-z0-9_]*\)` | `\([a-z]*\.c\)` |$/\1 \2/p' "$SRCDIR/fuzz/README.md" |
    sort >"$work/table"
cut -d' ' -f1 "$work/table" | uniq >"$work/listed"

{
    [ -s "$work/core" ] && [ -s "$work/full" ] || echo "no symbols: $(cat "$work/errors")"
    [ -s "$work/table" ] || echo "no table in fuzz/README.md"
} >"$work/wrong"
report "libraries and table can be read" "$work/wrong"

comm -23 "$work/exported" "$work/listed" >"$work/wrong"
report "every exported function is in the table" "$work/wrong"

comm -13 "$work/exported" "$work/listed" >"$work/wrong"
report "every function of the table is exported" "$work/wrong"

for source in "$SRCDIR"/fuzz/*.c; do
    code "$source" >"$work/$(basename "$source")"
done
while read -r function target; do
    grep -qw "$function" "$work/$target" || echo "$target does not call $function"
done <"$work/table" >"$work/wrong" 2>&1
report "each target calls what the table says" "$work/wrong"

for source in "$SRCDIR"/fuzz/*.c; do
    room=$(basename "$source" .c)
    [ -d "$SRCDIR/fuzz/corpus/$room" ] || echo "fuzz/corpus/$room is missing"
done >"$work/wrong"
report "each target has a corpus" "$work/wrong"

find "$SRCDIR/fuzz/corpus" -type f -exec sha1sum {} + | awk '{
    name = $2
    sub(/.*\//, "", name)
    if (name != $1) print $2 " is not named by its SHA-1"
}' >"$work/wrong"
report "files of the corpus are named by their content" "$work/wrong"

for folder in "$SRCDIR"/fuzz/corpus/*; do
    count=$(find "$folder" -type f | wc -l)
    bytes=$(cat "$folder"/* | wc -c)
    [ "$count" -le 200 ] && [ "$bytes" -le 102400 ] || echo "$folder: $count files, $bytes bytes"
done >"$work/wrong"
report "each corpus is small: up to 200 files and 100 KiB" "$work/wrong"
