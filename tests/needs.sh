#!/usr/bin/env bash
# Only what the scene needs: who calls hull code, libccd and the allocator, by counters in a program
# that wraps them; and what the libraries pull in.
set -u
cd "${SRCDIR:-$(dirname "$0")/..}" || exit 2
export LC_ALL=C
: "${BUILD:=$PWD/build}" "${CC:=gcc}"
work=$BUILD/needs
rm -rf "$work" && mkdir -p "$work" || exit 2

check() # NAME COMMAND...; what the command prints is shown if it fails
{
    local name=$1 out
    shift
    if out=$("$@" 2>&1); then
        echo "ok - $name"
    else
        echo "not ok - $name"
        echo "$out" | head -n 20 | sed 's/^/# /'
    fi
}

counters()
{
    local wrap=() name
    for name in ccdMPRPenetration convex_axis hull_head_is_valid hull_support; do
        wrap+=("-Wl,--wrap=$name")
    done
    # shellcheck disable=SC2086 # the flags are words
    $CC ${CPPFLAGS:-} ${CFLAGS:-} -std=c99 -Iinclude -Isrc tests/needs/counters.c ${LDFLAGS:-} \
        "${wrap[@]}" "$BUILD/libtribo.a" "$BUILD/libtribo_core.a" -lccd -lqhull_r -lm \
        -o "$work/counters" >"$work/log" 2>&1 || {
        echo "not ok - counters can be built"
        head -n 10 "$work/log" | sed 's/^/# /'
        return
    }
    "$work/counters" || echo "not ok - counters run to their end"
}

needed()
{
    readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'
}

# The root is an instruction: even libm may be left out.
core_needs_libm_alone()
{
    needed "$BUILD/libtribo_core.so" >"$work/core"
    cat "$work/core"
    grep -q '^libc\.' "$work/core" && ! grep -qvE '^lib[mc]\.' "$work/core"
}

full_needs_them()
{
    needed "$BUILD/libtribo.so" >"$work/full"
    cat "$work/full"
    grep -q '^libtribo_core\.' "$work/full" && grep -q '^libccd\.' "$work/full" &&
        grep -q '^libqhull_r\.' "$work/full"
}

# One object alone asks each of the other libraries.
asked_by()
{
    nm -A "$BUILD/libtribo.a" 2>/dev/null | sed -n "s/.*libtribo\.a:\([^:]*\):.* U $1.*/\1/p" |
        sort -u >"$work/asked"
    cat "$work/asked"
    [ "$(cat "$work/asked")" = "$2" ]
}

cat >"$work/impact.c" <<'EOF'
#include <tribo/tribo.h>

int main(void)
{
    static const double point[3] = {0, 0, -1};
    static const double normal[3] = {0, 0, 1};
    static const tribo_material pair = {0.3, 0.3, 0.5};
    tribo_body ball;
    double mass, inertia[9];
    return tribo_body_init(&ball) != TRIBO_OK ||
           tribo_mass_sphere(1.0, 1.0, &mass, inertia) != TRIBO_OK ||
           tribo_body_set_mass(&ball, mass, inertia) != TRIBO_OK ||
           tribo_collide(&ball, NULL, point, normal, &pair, NULL, NULL) != TRIBO_OK;
}
EOF

# program_needs_neither NAME LIBRARY...: it links with these alone, and holds nothing of the others.
program_needs_neither()
{
    local program=$work/$1
    shift
    # shellcheck disable=SC2086 # the flags are words
    $CC ${CFLAGS:-} -std=c99 -Iinclude "$work/impact.c" ${LDFLAGS:-} "$@" -lm -o "$program" &&
        "$program" || return 1
    if { needed "$program"; nm "$program"; } | grep -iE 'ccd|qhull|qh_|hull_|convex_'; then
        return 1
    fi
}

{
    counters
    check "libtribo_core needs libm alone" core_needs_libm_alone
    check "libtribo needs libtribo_core, libccd and Qhull" full_needs_them
    check "convex.c alone asks libccd" asked_by ccd convex.o
    check "hull.c alone asks Qhull" asked_by qh_ hull.o
    check "a program of libtribo_core holds no shapes, libccd or Qhull" \
        program_needs_neither shared "$BUILD/libtribo_core.so" "-Wl,-rpath,$BUILD"
    check "nor does one that is linked statically" \
        program_needs_neither static "$BUILD/libtribo_core.a"
} | awk '
    /^ok / { sub(/^ok/, "ok " ++n) }
    /^not ok / { sub(/^not ok/, "not ok " ++n); failed = 1 }
    { print }
    END { print "1.." n; exit failed }'
