// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "twin/base/image.h"

namespace kerfbench {

/// How fast a camera hands out its pictures. A sensor reads whole rows, each once, whatever columns are asked
/// for; the link then carries the windows alone, while the next exposure goes on.
struct ReadOut {
  double row_s{};             ///< Time of a row; 0: no matter how many.
  double link_bytes_per_s{};  ///< 0: no limit.

  /// Time that a frame takes of these windows.
  [[nodiscard]] double time_s(std::span<const PixelWindow> windows, int bits) const {
    std::vector<std::pair<int, int>> rows;
    std::size_t pixels = 0;
    for (const PixelWindow& window : windows) {
      pixels += window.area();
      if (!window.empty()) rows.emplace_back(window.top, window.bottom() + 1);
    }
    std::ranges::sort(rows);
    int count = 0;
    int read_to = 0;
    for (const auto& [first, end] : rows) {
      count += std::max(0, end - std::max(first, read_to));
      read_to = std::max(read_to, end);
    }
    const double bytes = static_cast<double>(pixels) * (bits > 8 ? 2.0 : 1.0);
    return std::max(count * row_s, link_bytes_per_s > 0.0 ? bytes / link_bytes_per_s : 0.0);
  }
};

}  // namespace kerfbench
