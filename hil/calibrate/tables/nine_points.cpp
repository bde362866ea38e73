// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/nine_points.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "hil/calibrate/tables/table_text.h"

namespace kerfbench::calibrate {
namespace {

constexpr int kMostIndex = 32;
constexpr double kMostScale_mm = 1e3;
constexpr std::string_view kScaleKey = "# mm_per_index:";

/// The largest whole index whose place, either side, the grid covers.
int reach(const std::vector<double>& places, double mm_per_index) {
  const double least_mm = std::min(-places.front(), places.back());
  const double indices = least_mm / mm_per_index;
  return static_cast<int>(std::clamp(std::floor(indices * (1.0 + 1e-12)), -1.0, 1.0 * kMostIndex));
}

void readScale(std::string_view line, std::size_t number, const NinePointOptions& options,
               TableFaults& faults, double& mm_per_index) {
  double value = 0.0;
  if (!numberOf(trimmed(line.substr(kScaleKey.size())), kMostScale_mm, number, faults, value)) return;
  if (value <= 0.0) {
    faults.atLine(number, "mm_per_index must be above 0");
  } else if (options.mm_per_index && *options.mm_per_index != value) {
    faults.atLine(number, fmt::format("the file's mm_per_index is {:g}, asked for is {:g}", value,
                                      *options.mm_per_index));
  } else {
    mm_per_index = value;
  }
}

void readPoint(std::string_view line, std::size_t number, TableFaults& faults, std::vector<TextNode>& nodes) {
  if (line.front() == 'X' || line.front() == 'Y') {
    faults.atLine(number,
                  "a point of a mount's axis is no part of the head's correction: take the X and Y "
                  "lines out, and turn the mount's frame in the job");
    return;
  }
  const std::size_t before = nodes.size();
  addNode(wordsOf(line), number, faults, nodes);
  if (nodes.size() == before) return;
  for (const double index : {nodes.back().value[0], nodes.back().value[1]}) {
    if (index != std::floor(index) || std::abs(index) > kMostIndex)
      faults.atLine(number, fmt::format("{:g} is no whole index within ±{}", index, kMostIndex));
  }
}

}  // namespace

std::string ninePointText(const AimGrid& grid, const NinePointOptions& options) {
  const double side_mm =
      std::min({-grid.x_mm().front(), grid.x_mm().back(), -grid.y_mm().front(), grid.y_mm().back()});
  if (!(side_mm > 0.0))
    throw std::invalid_argument("nine points lie around (0, 0), which the table does not");
  const double mm_per_index = options.mm_per_index.value_or(side_mm / kMostIndex);
  if (!(mm_per_index > 0.0 && mm_per_index <= kMostScale_mm))
    throw std::invalid_argument(fmt::format("an index of {:g} mm is none", mm_per_index));
  const int x_index = reach(grid.x_mm(), mm_per_index);
  const int y_index = reach(grid.y_mm(), mm_per_index);
  if (std::min(x_index, y_index) < 1)
    throw std::invalid_argument(
        fmt::format("the table does not reach to the first index, {:g} mm", mm_per_index));
  std::string text = fmt::format(
      "# nine points: ix iy x_wrong_mm y_wrong_mm; x along belt travel, y across, (0, 0) under the resting "
      "beam\n"
      "# x_wrong, y_wrong: how far the uncorrected point lies beside where it is wanted, to be subtracted\n"
      "# biquadratic between the points; outside nothing\n"
      "# nodes: 3 x 3\n"
      "{} {}\n",
      kScaleKey, mm_per_index);
  for (const int iy : {-y_index, 0, y_index}) {
    for (const int ix : {-x_index, 0, x_index}) {
      const Eigen::Vector2d p = mm_per_index * Eigen::Vector2d(ix, iy);
      const Eigen::Vector2d wrong = Eigen::Vector2d::Zero() - *grid.at_mm(p);
      text += fmt::format("{} {} {} {}\n", ix, iy, wrong.x(), wrong.y());
    }
  }
  return text;
}

AimGrid parseNinePointText(const std::string& text, const std::string& name,
                           const NinePointOptions& options) {
  TableFaults faults(name);
  std::vector<TextNode> nodes;
  double mm_per_index = options.mm_per_index.value_or(kGlaseMmPerIndex);
  forEachLine(text, [&](std::size_t number, std::string_view line) {
    if (line.starts_with(kScaleKey)) readScale(line, number, options, faults, mm_per_index);
    const std::string_view content = trimmed(line.substr(0, line.find('#')));
    if (!content.empty()) readPoint(content, number, faults, nodes);
  });
  if (!(mm_per_index > 0.0 && mm_per_index <= kMostScale_mm))
    faults.ofFile(fmt::format("an index of {:g} mm is none", mm_per_index));
  if (!faults.any() && nodes.size() != 9)
    faults.ofFile(fmt::format("nine points are wanted, here are {}", nodes.size()));
  faults.throwIfAny();
  for (TextNode& node : nodes) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      node.value.at(axis) *= mm_per_index;
      node.value.at(axis + 2) = 0.0 - node.value.at(axis + 2);
    }
  }
  return gridOf(text, nodes, faults, Between::kHermite, Outside::kRefused);
}

}  // namespace kerfbench::calibrate
