#!/usr/bin/env bash
# What a user of the installed library meets: staged install, pkg-config, C and C++ programs,
# uninstall; headers that stand alone; a shared library that calls nothing that it should not.
set -u
cd "${SRCDIR:-$(dirname "$0")/..}" || exit 2
export LC_ALL=C
: "${BUILD:=$PWD/build}" "${CC:=gcc}" "${CXX:=g++}"
work=$BUILD/install
stage=$work/stage
library=$stage/usr/lib/libtribo_core.so
rm -rf "$work" && mkdir -p "$work" || exit 2

echo 1..12
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
        echo "$out" | head -n 30 | sed 's/^/# /'
        failures=$((failures + 1))
    fi
}
check_with() # TOOL NAME COMMAND...
{
    local tool=$1
    shift
    if command -v "$tool" >/dev/null; then
        check "$@"
    else
        number=$((number + 1))
        echo "ok $number - $1 # SKIP $tool is not installed"
    fi
}

# The same flags as the build, so that nothing is built again.
run_make()
{
    MAKEFLAGS='' make -s "$@" BUILD="$BUILD" CC="$CC" CFLAGS="${CFLAGS--O3 -g}" \
        CPPFLAGS="${CPPFLAGS-}" LDFLAGS="${LDFLAGS-}" DESTDIR="$stage" PREFIX=/usr
}

pkg()
{
    PKG_CONFIG_SYSROOT_DIR=$stage PKG_CONFIG_LIBDIR=$stage/usr/lib/pkgconfig \
        PKG_CONFIG_ALLOW_SYSTEM_CFLAGS=1 PKG_CONFIG_ALLOW_SYSTEM_LIBS=1 pkg-config "$@" tribo_core
}

cat >"$work/user.c" <<'EOF'
#include <tribo/tribo.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    const double v[3] = {3, 4, 0};
    double unit[3];
    if (tribo_vec3_normalize(v, unit) != TRIBO_OK || tribo_vec3_dot(v, unit) != 5) {
        return 1;
    }
    return strcmp(tribo_version_string(), VERSION) != 0 || tribo_version() < 100;
}
EOF
cp "$work/user.c" "$work/user.cc"
# Takes addresses: the exported twins of inline functions must be there, too.
cat >"$work/twin.c" <<'EOF'
#include <tribo/math.h>
double (*volatile dot)(const double *, const double *) = tribo_vec3_dot;
int main(void)
{
    const double v[3] = {1, 2, 2};
    return dot(v, v) != 9;
}
EOF

files_are_installed()
{
    local file missing=0
    for file in bin/tribo lib/libtribo_core.a lib/libtribo_core.so lib/libtribo_core.so.0 \
        lib/pkgconfig/tribo_core.pc lib/libtribo.a lib/libtribo.so lib/libtribo.so.0 \
        lib/pkgconfig/tribo.pc $(cd include && ls -d tribo/*.h | sed 's|^|include/|'); do
        [ -e "$stage/usr/$file" ] || { echo "$file is not installed" && missing=1; }
    done
    return $missing
}

user() # COMPILER SOURCE FLAGS...
{
    local compiler=$1 source=$2
    shift 2
    # shellcheck disable=SC2046 # the flags of pkg-config are words
    "$compiler" "$@" "-DVERSION=\"$(pkg --modversion)\"" "$work/$source" \
        $(pkg --cflags --libs) -o "$work/$source.shared" &&
        LD_LIBRARY_PATH=$stage/usr/lib "$work/$source.shared" &&
        "$compiler" "$@" "-DVERSION=\"$(pkg --modversion)\"" "$work/$source" $(pkg --cflags) \
            -Wl,-Bstatic $(pkg --libs --static) -Wl,-Bdynamic -o "$work/$source.static" &&
        "$work/$source.static"
}

fails_without_flags()
{
    ! "$CC" "-DVERSION=\"\"" -fsyntax-only "$work/user.c"
}

program_runs()
{
    "$stage/usr/bin/tribo" --help
}

# Lines of standard input that do not match; no line at all is wrong, too: nothing was looked at.
none_but()
{
    awk -v allowed="^($1)$" '{ lines++ } $0 !~ allowed { print; bad++ } END { exit !lines || bad }'
}

needs_only_libm_and_libc()
{
    readelf -d "$library" | awk '/NEEDED/ { print $NF }' | none_but '\\[lib[mc]\\.so\\.6\\]'
}

soname_is_right()
{
    readelf -d "$library" | grep SONAME | grep -qF '[libtribo_core.so.0]' &&
        [ "$(readlink "$library")" = "libtribo_core.so.$(pkg --modversion)" ]
}

# What a library that never allocates, prints, aborts or looks at its environment may call.
calls_nothing_else()
{
    local start='__cxa_finalize|__gmon_start__|_ITM_(de)?registerTMCloneTable|__stack_chk_fail'
    local dispatch='__cpu_model|__cpu_indicator_init'
    nm -D --undefined-only "$library" | awk '{ sub(/@.*/, "", $2); print $2 }' |
        none_but "$start|$dispatch|sqrt|mem(cpy|move|set|cmp)|str(n?cmp|len)"
}

headers_stand_alone()
{
    local compiler=$1 header
    shift
    for header in include/tribo/*.h; do
        echo "#include <${header#include/}>" |
            "$compiler" "$@" -Wall -Wextra -Werror -pedantic-errors -Iinclude -fsyntax-only - ||
            return 1
    done
}

nothing_is_left()
{
    run_make uninstall && [ -z "$(find "$stage" ! -type d)" ] && [ ! -e "$stage/usr/include/tribo" ]
}

check "staged install" run_make install
check "libraries, headers, pkg-config file and program are there" files_are_installed
check_with pkg-config "a C program through pkg-config, shared and static" \
    user "$CC" user.c -std=c99 -Wall -Wextra -Werror -pedantic-errors
check_with pkg-config "a program that takes addresses of inline functions" \
    user "$CC" twin.c -std=c99 -O0
if command -v "$CXX" >/dev/null; then
    check_with pkg-config "a C++11 program through pkg-config, shared and static" \
        user "$CXX" user.cc -std=c++11 -Wall -Wextra -Werror -pedantic-errors
    check "each header alone is C++11" headers_stand_alone "$CXX" -x c++ -std=c++11
else
    check_with "$CXX" "a C++11 program through pkg-config, shared and static"
    check_with "$CXX" "each header alone is C++11"
fi
check "each header alone is strict C99" headers_stand_alone "$CC" -x c -std=c99
check "without pkg-config's flags it does not compile" fails_without_flags
check "the installed program runs" program_runs
check_with pkg-config "soname and link" soname_is_right
check "the library needs libm and libc and calls only what it may" \
    eval 'needs_only_libm_and_libc && calls_nothing_else'
check "uninstall leaves no file" nothing_is_left
exit $((failures > 0))
