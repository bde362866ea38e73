// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/grid_text.h"

#include <vector>

#include <fmt/format.h>

#include "hil/calibrate/tables/table_text.h"

namespace kerfbench::calibrate {

std::string gridText(const AimGrid& grid) {
  std::string text =
      "; grid-text: correction of a scan field, by the rules of RTC boards for theirs\n"
      "; x y dx dy, mm, x along belt travel, y across, (0, 0) under the resting beam\n"
      "; dx, dy: desired minus measured position, added to what is aimed at\n"
      "; bilinear between nodes, linear beyond the outermost cells\n";
  text += fmt::format("; {}\n", nodesNote(grid));
  for (std::size_t row = 0; row < grid.y_mm().size(); ++row) {
    for (std::size_t column = 0; column < grid.x_mm().size(); ++column) {
      const Eigen::Vector2d& d = grid.d_mm(column, row);
      text += fmt::format("{} {} {} {}\n", grid.x_mm()[column], grid.y_mm()[row], d.x(), d.y());
    }
  }
  return text;
}

AimGrid parseGridText(const std::string& text, const std::string& name) {
  TableFaults faults(name);
  std::vector<TextNode> nodes;
  forEachLine(text, [&](std::size_t number, std::string_view line) {
    const std::string_view content = trimmed(line.substr(0, line.find_first_of(";#")));
    if (content.empty()) return;
    addNode(wordsOf(content), number, faults, nodes);
  });
  return gridOf(text, nodes, faults, Between::kBilinear, Outside::kLinear);
}

}  // namespace kerfbench::calibrate
