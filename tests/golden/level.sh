# For tests/golden*.sh.
#
# has_level x86-64-v3|x86-64-v4: whether this processor runs what is compiled for it
has_level()
{
    local feature features="avx2 bmi2 fma movbe"
    [ "$1" = x86-64-v4 ] && features="avx512f avx512bw avx512cd avx512dq avx512vl"
    for feature in $features; do
        grep -qw "$feature" /proc/cpuinfo || return 1
    done
}
