#!/bin/sh
# What the bindings share: the interface as data, and the test vectors. TAP.
#
#   tests/bindings.sh [--update]      --update writes bindings/api.json, bindings/vectors.json and what
#                                     bindings generate from them anew
set -u
SRCDIR=$(cd "${SRCDIR:-.}" && pwd)
BUILD=${BUILD:-$SRCDIR/build}
vectors=$BUILD/bindings/vectors
cd "$SRCDIR/bindings" || exit 2

# The Python that has libclang, if one has.
python=python3
for candidate in python3 /usr/bin/python3; do
    "$candidate" -c 'import clang.cindex' 2>/dev/null && python=$candidate && break
done

if [ "${1:-}" = --update ]; then
    "$python" api.py write && "$vectors" >vectors.json || exit
    for generate in */generate.py; do
        "$python" "$generate" write || exit
    done
    exit
fi

echo 1..2
if ! command -v "$python" >/dev/null; then
    echo "ok 1 - every public function is bound # SKIP no Python 3"
elif out=$("$python" api.py check); then
    echo "ok 1 - every public function is bound"
    echo "$out"
else
    echo "not ok 1 - every public function is bound"
    echo "$out" | sed 's/^/# /'
fi
if "$vectors" | cmp - vectors.json; then
    echo "ok 2 - test vectors are those of the library"
else
    echo "not ok 2 - test vectors are those of the library"
fi
