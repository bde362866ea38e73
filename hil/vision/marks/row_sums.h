// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace kerfbench::vision {

// Private to this room: sums over the pixels of a look at a printed disc.

/// Sums over pixels of a row whose levels lie within bounds; k counts the row's pixels from 0.
struct RowSums {
  double n{0.0}, k{0.0}, kk{0.0}, p{0.0}, pk{0.0}, pp{0.0};
};

template <typename Level>
RowSums sumRow(const Level* levels, int count, std::uint32_t least, std::uint32_t most) {
  constexpr int kPiece = 64;  // Sums of so many fit into 32 bits at every depth.
  RowSums sums;
  for (int begin = 0; begin < count; begin += kPiece) {
    std::uint32_t n = 0, k = 0, kk = 0, p = 0, pk = 0, pp = 0;
    const auto size = static_cast<std::uint32_t>(std::min(kPiece, count - begin));
    const Level* const piece = levels + begin;
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint32_t level = piece[i];
      const std::uint32_t counts =
          static_cast<std::uint32_t>(level >= least) & static_cast<std::uint32_t>(level <= most);
      const std::uint32_t place = counts * i;
      const std::uint32_t value = counts * level;
      n += counts;
      k += place;
      kk += place * i;
      p += value;
      pk += value * i;
      pp += value * level;
    }
    sums.n += n;
    sums.k += k + static_cast<double>(begin) * n;
    sums.kk += kk + static_cast<double>(begin) * (2.0 * k + static_cast<double>(begin) * n);
    sums.p += p;
    sums.pk += pk + static_cast<double>(begin) * p;
    sums.pp += pp;
  }
  return sums;
}

}  // namespace kerfbench::vision
