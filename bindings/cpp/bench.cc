// What a call costs through the header: see ../cost.c.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <tribo/tribo.hpp>

namespace {

constexpr std::size_t count = 10000;
std::uint64_t state = 1;

double unit()
{
    state += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return static_cast<double>(z >> 11) * 0x1p-53;
}

double nanoseconds(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start)
               .count() /
           count;
}

} // namespace

int main()
{
    std::vector<tribo::sym3> w(count);
    std::vector<tribo::vec3> b(count);
    std::vector<double> flat_w, flat_b, mu, p(3 * count);
    std::vector<std::uint32_t> modes(count);
    for (std::size_t k = 0; k < count; k++) {
        for (std::size_t i = 0; i < 6; i++) {
            const double side = 2.0 * unit() - 1.0;
            w[k][i] = i == 0 || i == 3 || i == 5 ? 2.0 + side : 0.5 * side;
        }
        for (double &number : b[k]) {
            number = 2.0 * unit() - 1.0;
        }
        const double mu_s = 2.0 * unit();
        mu.insert(mu.end(), {mu_s, unit() * mu_s});
        unit();
        flat_w.insert(flat_w.end(), w[k].begin(), w[k].end());
        flat_b.insert(flat_b.end(), b[k].begin(), b[k].end());
    }
    double single = 1e300, batch = 1e300, sum = 0.0;
    for (int round = 0; round < 50; round++) {
        auto start = std::chrono::steady_clock::now();
        for (std::size_t k = 0; k < count; k++) {
            sum += tribo::solve(w[k], b[k], mu[2 * k], mu[2 * k + 1]).impulse[0];
        }
        single = std::min(single, nanoseconds(start));
        start = std::chrono::steady_clock::now();
        tribo::batch_solve(flat_w, flat_b, mu, p, modes);
        batch = std::min(batch, nanoseconds(start));
    }
    std::printf("C++\t%.1f\t%.1f%s\n", single, batch, sum < 0.0 ? " " : "");
    return 0;
}
