// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/burnt_lines.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

namespace kerfbench::scene {
namespace {

using Eigen::Vector3d;

// The point of line[first … last] that lies farthest from the chord between these two, and how far.
std::pair<std::size_t, double> farthestFromChord(const std::vector<Vector3d>& line, std::size_t first,
                                                 std::size_t last) {
  const Vector3d chord = line[last] - line[first];
  std::pair<std::size_t, double> worst{first, 0.0};
  for (std::size_t i = first + 1; i < last; ++i) {
    const Vector3d q = line[i] - line[first];
    const double along =
        chord.squaredNorm() > 0 ? std::clamp(q.dot(chord) / chord.squaredNorm(), 0.0, 1.0) : 0.0;
    const double off = (q - along * chord).norm();
    if (off > worst.second) worst = {i, off};
  }
  return worst;
}

// Drops points that lie within `tolerance` of the chord (Douglas and Peucker 1973). A stack instead of calls:
// a spiral splits as often as it has points.
std::vector<Vector3d> thinned(const std::vector<Vector3d>& line, double tolerance) {
  std::vector<Vector3d> kept{line.front()};
  std::vector<std::size_t> ends{line.size() - 1};
  std::size_t first = 0;
  while (!ends.empty()) {
    const auto [at, off] = farthestFromChord(line, first, ends.back());
    if (off > tolerance) {
      ends.push_back(at);
    } else {
      first = ends.back();
      ends.pop_back();
      kept.push_back(line[first]);
    }
  }
  return kept;
}

// How large a pixel is where the line comes nearest to the eye; nothing where all of it lies behind.
std::optional<double> finestPixel_mm(const std::vector<Vector3d>& line, const Viewpoint& view) {
  std::optional<double> finest;
  for (const Vector3d& p : line) {
    const double px = view.pixel_mm(p);
    if (px > 0 && (!finest || px < *finest)) finest = px;
  }
  return finest;
}

}  // namespace

std::vector<BurntLine> burntLines(const twin::Scene& scene, const Viewpoint& view) {
  constexpr double kKerf_mm = 0.105;  // Half the width of a usual kerf.
  std::vector<BurntLine> lines;
  for (const auto& line : scene.burnt) {
    const std::optional<double> visible_mm = finestPixel_mm(line, view);
    if (!visible_mm) continue;
    // Near the eye's plane a pixel is as small as one likes; a tenth of the kerf is fine enough.
    const double px = std::max(*visible_mm, 0.1 * kKerf_mm);
    lines.push_back({thinned(line, 0.3 * px), std::max(kKerf_mm, 0.75 * px)});
  }
  return lines;
}

}  // namespace kerfbench::scene
