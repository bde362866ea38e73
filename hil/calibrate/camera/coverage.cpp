// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/coverage.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace kerfbench::calibrate {
namespace {

constexpr std::array<std::array<const char*, 3>, 3> kParts{{{"upper left", "top", "upper right"},
                                                            {"left", "middle", "right"},
                                                            {"lower left", "bottom", "lower right"}}};

}  // namespace

int coverageCells(int width_px, int height_px) {
  return std::clamp(std::min(width_px, height_px) / 100, 4, 10);
}

std::vector<int> coverageOf(const std::vector<TargetCorner>& corners, int width_px, int height_px) {
  const int cells = coverageCells(width_px, height_px);
  std::vector<int> count(static_cast<std::size_t>(cells * cells), 0);
  const auto cell = [cells](double at, int size) {
    return std::clamp(static_cast<int>((at + 0.5) / size * cells), 0, cells - 1);
  };
  for (const TargetCorner& corner : corners) {
    const int index = cell(corner.pixel.y(), height_px) * cells + cell(corner.pixel.x(), width_px);
    ++count[static_cast<std::size_t>(index)];
  }
  return count;
}

std::string coverageFault(const std::vector<TargetCorner>& corners, int width_px, int height_px) {
  const int cells = coverageCells(width_px, height_px);
  const std::vector<int> count = coverageOf(corners, width_px, height_px);
  const auto third = [cells](int cell) { return static_cast<std::size_t>(3 * cell / cells); };
  std::array<std::array<int, 3>, 3> empty{};
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const bool bare = count[static_cast<std::size_t>(row * cells + column)] == 0;
      empty.at(third(row)).at(third(column)) += bare ? 1 : 0;
    }
  }
  std::string parts;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (empty.at(r).at(c) == 0) continue;
      parts +=
          fmt::format("{}{} ({} cells)", parts.empty() ? "" : ", ", kParts.at(r).at(c), empty.at(r).at(c));
    }
  }
  if (parts.empty()) return {};
  return fmt::format(
      "the target does not cover the picture: of {} x {} cells, these have no corner of it: {}; the map "
      "would be "
      "a guess there",
      cells, cells, parts);
}

}  // namespace kerfbench::calibrate
