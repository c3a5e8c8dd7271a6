// SPDX-License-Identifier: BSD-3-Clause
// odeint.cpp -- P(n) of docs/project/speed.md for t seconds under boost::odeint's dopri5
// at a tolerance of 1e-6, its right-hand side a loop over a list of springs: n t file.
// Prints the seconds that it took; positions at the end go to the file, x y z of
// particle after particle.
#include <boost/numeric/odeint.hpp>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace
{

using State = std::vector<double>; // x y z of all particles, then their velocities

struct Spring {
    std::size_t p, q;
    double stiffness, rest, damping; // [N/m], [m], [kg/s]
};

struct Cloth {
    std::size_t n;
    std::vector<Spring> springs;

    explicit Cloth(std::size_t side) : n(side)
    {
        add(0, 1, 100.0), add(1, 0, 100.0), add(1, 1, 50.0);
        add(1, -1, 50.0), add(0, 2, 10.0), add(2, 0, 10.0);
    }

    void add(int down, int right, double stiffness)
    {
        const double rest = std::hypot(down, right) / static_cast<double>(n - 1);
        const int side = static_cast<int>(n);
        for (int r = 0; r + down < side; ++r) {
            for (int c = right < 0 ? -right : 0; c + (right > 0 ? right : 0) < side;
                 ++c) {
                const auto p = static_cast<std::size_t>(r * side + c);
                const auto q = static_cast<std::size_t>((r + down) * side + c + right);
                springs.push_back({ p, q, stiffness, rest, 5e-4 * stiffness });
            }
        }
    }

    State start() const
    {
        State y(6 * n * n, 0.0);
        for (std::size_t i = 0; i < n * n; ++i) {
            y[3 * i] = static_cast<double>(i % n) / static_cast<double>(n - 1);
            y[3 * i + 2] = static_cast<double>(i / n) / static_cast<double>(n - 1);
        }
        return y;
    }

    void operator()(const State &y, State &dydt, double) const
    {
        const std::size_t half = 3 * n * n;
        const double *v = &y[half];
        double *a = &dydt[half];
        for (std::size_t j = 0; j < half; ++j) {
            dydt[j] = v[j];
            a[j] = 0.0;
        }
        for (const Spring &s : springs) {
            double d[3], rate = 0.0, square = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                d[k] = y[3 * s.q + k] - y[3 * s.p + k];
                square += d[k] * d[k];
                rate += (v[3 * s.q + k] - v[3 * s.p + k]) * d[k];
            }
            const double length = std::sqrt(square);
            const double pull =
                (s.stiffness * (length - s.rest) + s.damping * rate / length) / length;
            for (std::size_t k = 0; k < 3; ++k) {
                a[3 * s.p + k] += pull * d[k];
                a[3 * s.q + k] -= pull * d[k];
            }
        }
        const double inverse_mass = static_cast<double>(n * n) / 0.2;
        for (std::size_t i = 0; i < n * n; ++i) {
            const bool pinned = i == 0 || i == n - 1;
            for (std::size_t k = 0; k < 3; ++k) {
                const double g = k == 1 ? -9.81 : 0.0;
                a[3 * i + k] = pinned ? 0.0 : a[3 * i + k] * inverse_mass + g;
            }
        }
    }
};

} // namespace

int main(int argc, char **argv)
{
    namespace odeint = boost::numeric::odeint;
    if (argc != 4) {
        std::fputs("odeint: n, t [s], file\n", stderr);
        return 2;
    }
    const Cloth cloth(static_cast<std::size_t>(std::atoi(argv[1])));
    State y = cloth.start();
    const auto began = std::chrono::steady_clock::now();
    odeint::integrate_adaptive(
        odeint::make_controlled(1e-6, 0.0, odeint::runge_kutta_dopri5<State>()),
        std::cref(cloth), y, 0.0, std::atof(argv[2]), 1e-5);
    const std::chrono::duration<double> seconds =
        std::chrono::steady_clock::now() - began;
    std::FILE *file = std::fopen(argv[3], "wb");
    if (file == nullptr ||
        std::fwrite(y.data(), sizeof y[0], y.size() / 2, file) != y.size() / 2 ||
        std::fclose(file) != 0) {
        std::perror(argv[3]);
        return 1;
    }
    std::printf("%.6g\n", seconds.count());
}
