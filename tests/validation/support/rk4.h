// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace kerfbench::validation {

/// Makes one classical Runge-Kutta step of y' = f(t, y) from `time_s`. `f(time_s, y, derivative)`.
template <std::size_t N, typename F>
void rk4Step(std::array<double, N>& y, double time_s, double step_s, const F& f) {
  std::array<double, N> k1{}, k2{}, k3{}, k4{}, at{};
  const auto shifted = [&y, &at](const std::array<double, N>& k, double h) -> const std::array<double, N>& {
    for (std::size_t i = 0; i < N; ++i) at[i] = y[i] + h * k[i];
    return at;
  };
  f(time_s, y, k1);
  f(time_s + 0.5 * step_s, shifted(k1, 0.5 * step_s), k2);
  f(time_s + 0.5 * step_s, shifted(k2, 0.5 * step_s), k3);
  f(time_s + step_s, shifted(k3, step_s), k4);
  for (std::size_t i = 0; i < N; ++i) y[i] += step_s / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
}

}  // namespace kerfbench::validation
