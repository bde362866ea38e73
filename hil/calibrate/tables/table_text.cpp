// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/table_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/base/number_from.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kFarthest_mm = 1e5;
constexpr double kLargest_mm = 1e4;
constexpr std::size_t kMostTextNodes = AimGrid::kMostNodes * AimGrid::kMostNodes;

std::vector<double> places(const std::vector<TextNode>& nodes, std::size_t axis) {
  std::vector<double> all;
  for (const TextNode& node : nodes) all.push_back(node.value.at(axis));
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());  // clang 14 does not bear std::ranges::unique.
  return all;
}

std::size_t indexOf(const std::vector<double>& places, double place) {
  return static_cast<std::size_t>(std::ranges::lower_bound(places, place) - places.begin());
}

constexpr std::string_view kNote = "nodes: ";

std::string noteOf(std::size_t columns, std::size_t rows) {
  return fmt::format("{}{} x {}", kNote, columns, rows);
}

void checkWhole(std::string_view text, const std::string& note, TableFaults& faults) {
  bool noted = false;
  forEachLine(text, [&](std::size_t number, std::string_view line) {
    if (line.empty() || (line.front() != '#' && line.front() != ';')) return;
    line = trimmed(line.substr(1));
    if (!line.starts_with(kNote)) return;
    noted = true;
    if (line != note)
      faults.atLine(number, fmt::format("the file says {} and has {}", base::inQuotes(line), note));
  });
  if (noted && !text.ends_with('\n')) faults.ofFile("the last line has no end: the file was cut off");
}

}  // namespace

std::string nodesNote(const AimGrid& grid) { return noteOf(grid.x_mm().size(), grid.y_mm().size()); }

void forEachLine(std::string_view text, const std::function<void(std::size_t, std::string_view)>& take) {
  std::size_t number = 0;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    take(++number, trimmed(text.substr(from, to - from)));
    from = to + 1;
  }
}

std::vector<std::string_view> wordsOf(std::string_view line, char separator) {
  std::vector<std::string_view> words;
  if (separator != ' ') {
    for (std::size_t from = 0; from <= line.size();) {
      const std::size_t to = std::min(line.find(separator, from), line.size());
      words.push_back(trimmed(line.substr(from, to - from)));
      from = to + 1;
    }
    return words;
  }
  for (std::size_t from = line.find_first_not_of(base::kBlanks); from != std::string_view::npos;) {
    const std::size_t to = std::min(line.find_first_of(base::kBlanks, from), line.size());
    words.push_back(line.substr(from, to - from));
    from = line.find_first_not_of(base::kBlanks, to);
  }
  return words;
}

bool numberOf(std::string_view word, double bound, std::size_t line, TableFaults& faults, double& value) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
  const auto number = base::numberFrom<double>(digits);
  if (!number || !std::isfinite(*number)) {
    faults.atLine(line, base::inQuotes(word) + " is no number");
    return false;
  }
  value = *number;
  if (std::abs(value) > bound) {
    faults.atLine(line, fmt::format("{:g} is beyond ±{:g}", value, bound));
    return false;
  }
  return true;
}

void addNode(const std::vector<std::string_view>& words, std::size_t line, TableFaults& faults,
             std::vector<TextNode>& nodes) {
  TextNode node{.line = line};
  if (words.size() != node.value.size())
    return faults.atLine(line, fmt::format("a node has 4 numbers, this line has {}", words.size()));
  bool good = true;
  for (std::size_t i = 0; i < node.value.size(); ++i)
    good = numberOf(words[i], i < 2 ? kFarthest_mm : kLargest_mm, line, faults, node.value.at(i)) && good;
  if (good && nodes.size() == kMostTextNodes) faults.atLine(line, "more nodes than 1025 x 1025");
  if (good && nodes.size() <= kMostTextNodes) nodes.push_back(node);
}

AimGrid gridOf(std::string_view text, const std::vector<TextNode>& nodes, TableFaults& faults,
               Between between, Outside outside) {
  faults.throwIfAny();
  const std::vector<double> x = places(nodes, 0);
  const std::vector<double> y = places(nodes, 1);
  const std::size_t least = between == Between::kHermite ? 3 : 2;
  if (std::min(x.size(), y.size()) < least || std::max(x.size(), y.size()) > AimGrid::kMostNodes) {
    faults.ofFile(fmt::format("a grid has {0} x {0} to {1} x {1} nodes, this one {2} x {3}", least,
                              AimGrid::kMostNodes, x.size(), y.size()));
  }
  checkWhole(text, noteOf(x.size(), y.size()), faults);
  faults.throwIfAny();
  std::vector<Eigen::Vector2d> d(x.size() * y.size());
  std::vector<std::size_t> line(d.size(), 0);
  for (const TextNode& node : nodes) {
    const std::size_t at = indexOf(y, node.value[1]) * x.size() + indexOf(x, node.value[0]);
    if (line[at] > 0) {
      faults.atLine(node.line, fmt::format("the node ({:g}, {:g}) was in line {} already", node.value[0],
                                           node.value[1], line[at]));
    }
    line[at] = node.line;
    d[at] = {node.value[2], node.value[3]};
  }
  for (std::size_t at = 0; at < d.size(); ++at) {
    if (line[at] == 0)
      faults.ofFile(fmt::format("the grid lacks the node ({:g}, {:g})", x[at % x.size()], y[at / x.size()]));
  }
  faults.throwIfAny();
  return {x, y, std::move(d), between, outside};
}

}  // namespace kerfbench::calibrate
