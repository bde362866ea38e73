// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/space/contour_file.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "hil/base/input_error.h"
#include "hil/base/number_from.h"
#include "hil/base/text.h"

namespace kerfbench::inspect {
namespace {

constexpr double kUnit = 0.01;
constexpr double kSamePlace_mm = 1e-6;

std::vector<std::string> wordsOf(std::string line) {
  line.resize(std::min(line.find_first_of("#;"), line.size()));
  std::ranges::replace(line, ',', ' ');
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// What is wrong with a line of the file, or its point.
std::string readPoint(const std::vector<std::string>& words, ContourPoint& point) {
  if (words[0] == "via" || words[0] == "centre" || words[0] == "bezier" || words[0] == "spline") {
    return fmt::format("'{}': arcs and curves are not judged; give the contour by points", words[0]);
  }
  if (words.size() != 6) return fmt::format("{} words where x y z i j k are wanted", words.size());
  Eigen::Matrix<double, 6, 1> numbers;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto number = base::numberFrom<double>(words[i]);
    if (!number || !std::isfinite(*number)) return base::inQuotes(words[i]) + " is no number";
    numbers[static_cast<Eigen::Index>(i)] = *number;
  }
  point.p_W_mm = numbers.head<3>();
  point.axis_W = numbers.tail<3>();
  const double length = point.axis_W.norm();
  if (!(std::abs(length - 1.0) <= kUnit)) return fmt::format("the axis has the length {:.4f}, not 1", length);
  point.axis_W /= length;
  return {};
}

}  // namespace

std::vector<ContourPoint> readContourFile(const std::string& text, const std::string& name) {
  std::vector<ContourPoint> points;
  std::string faults;
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::vector<std::string> words = wordsOf(line);
    if (words.empty()) continue;
    ContourPoint point;
    point.file_line = number;
    std::string fault = readPoint(words, point);
    if (fault.empty() && !points.empty() && (point.p_W_mm - points.back().p_W_mm).norm() < kSamePlace_mm)
      fault = "the point is the one before";
    if (!fault.empty()) {
      faults += fmt::format("{}{}:{}: {}", faults.empty() ? "" : "\n", name, number, fault);
    } else {
      points.push_back(point);
    }
  }
  if (faults.empty() && points.size() < 2) faults = fmt::format("{}: a contour has two points or more", name);
  if (!faults.empty()) throw base::InputError(faults);
  return points;
}

}  // namespace kerfbench::inspect
