// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/csv_table.h"

#include <vector>

#include <fmt/format.h>

#include "hil/calibrate/tables/table_text.h"

namespace kerfbench::calibrate {
namespace {

constexpr const char* kHeader = "x_mm,y_mm,dx_mm,dy_mm";

bool isHeader(std::string_view line, std::size_t number, TableFaults& faults) {
  std::string words;
  for (const std::string_view word : wordsOf(line, ','))
    words += (words.empty() ? "" : ",") + std::string(word);
  if (words == kHeader) return true;
  faults.atLine(number, words == "x_mm,y_mm,dx_steps,dy_steps"
                            ? "this table is of steps, which no other format holds: how many mm a step is "
                              "depends on the machine and the place"
                            : fmt::format("the header must be {}", kHeader));
  faults.throwIfAny();  // What has another header may be no table at all: its lines are not quoted.
  return false;
}

/// Order that the controller requires, in addition to a complete grid: y ascending, and for each y all x
/// ascending.
void checkOrder(const std::vector<TextNode>& nodes, TableFaults& faults) {
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const auto& before = nodes[i - 1].value;
    const auto& here = nodes[i].value;
    if (here[1] > before[1] || (here[1] == before[1] && here[0] > before[0])) continue;
    faults.atLine(nodes[i].line,
                  fmt::format("y must ascend, and x for each y: ({:g}, {:g}) after ({:g}, {:g})", here[0],
                              here[1], before[0], before[1]));
  }
}

}  // namespace

std::string csvTable(const AimGrid& grid) {
  std::string text =
      "# Correction table. A beam wanted at (x, y) is aimed at (x + dx, y + dy) in place of (x, y).\n"
      "# mm in the sheet's plane: x along belt travel, y across, (0, 0) under the resting beam.\n"
      "# y ascends, and for each y all x. Between nodes bicubic Hermite with five-node slopes; outside "
      "nothing.\n";
  text += fmt::format("# {}\n{}\n", nodesNote(grid), kHeader);
  for (std::size_t row = 0; row < grid.y_mm().size(); ++row) {
    for (std::size_t column = 0; column < grid.x_mm().size(); ++column) {
      const Eigen::Vector2d& d = grid.d_mm(column, row);
      text += fmt::format("{},{},{},{}\n", grid.x_mm()[column], grid.y_mm()[row], d.x(), d.y());
    }
  }
  return text;
}

AimGrid parseCsvTable(const std::string& text, const std::string& name) {
  TableFaults faults(name);
  std::vector<TextNode> nodes;
  bool header = false;
  forEachLine(text, [&](std::size_t number, std::string_view line) {
    if (line.empty() || line.front() == '#') return;
    if (!header) {
      header = true;
      (void)isHeader(line, number, faults);
      return;
    }
    addNode(wordsOf(line, ','), number, faults, nodes);
  });
  if (!header) faults.ofFile(fmt::format("there is no header {}", kHeader));
  faults.throwIfAny();
  checkOrder(nodes, faults);
  return gridOf(text, nodes, faults, Between::kHermite, Outside::kRefused);
}

}  // namespace kerfbench::calibrate
