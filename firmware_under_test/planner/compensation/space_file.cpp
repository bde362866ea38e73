// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/space_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/compensation/contour.h"
#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

constexpr double kVertical = 1e-9;
constexpr double kFarthestMm = 1e6;

std::vector<std::string> wordsOf(std::string line) {
  line.resize(std::min(line.find_first_of("#;"), line.size()));
  for (char& c : line) c = c == ',' || c == '\t' || c == '\r' ? ' ' : c;
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::optional<double> numberOf(const std::string& word) {
  double value{};
  const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Parses the six numbers of a line; returns what is wrong with it.
std::string parsePoint(const std::vector<std::string>& words, SpacePoint& point) {
  if (words.size() != 6) return fmt::format("{} values instead of the six x y z i j k", words.size());
  std::array<double, 6> values{};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::optional<double> value = numberOf(words[i]);
    if (!value) return fmt::format("'{}' is no number", words[i].substr(0, 40));
    if (std::abs(*value) > kFarthestMm) return fmt::format("{} is beyond {:g}", words[i], kFarthestMm);
    values[i] = *value;
  }
  point.p_mm = {values[0], values[1], values[2]};
  point.axis = {values[3], values[4], values[5]};
  return {};
}

double rounded(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }

}  // namespace

SpaceContour readSpaceContour(const std::string& text, const std::string& name) {
  SpaceContour contour;
  std::vector<std::string> faults;
  std::istringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::vector<std::string> words = wordsOf(line);
    if (words.empty()) continue;
    SpacePoint point;
    const std::string fault = parsePoint(words, point);
    if (fault.empty()) {
      contour.points.push_back(point);
      contour.file_lines.push_back(number);
    } else if (faults.size() < kMostFaults) {
      faults.push_back(fmt::format("{}: line {}: {}", name, number, fault));
    }
  }
  if (faults.empty() && contour.points.size() < 2) faults.push_back(name + ": a contour needs two points");
  if (!faults.empty()) throw CompensationError(fmt::format("{}", fmt::join(faults, "\n")));
  return contour;
}

std::vector<Pose> posesOf(const std::vector<SpacePoint>& path) {
  std::vector<Pose> poses;
  double c = 0.0;
  for (const SpacePoint& point : path) {
    const Eigen::Vector3d& n = point.axis;
    const double across = std::hypot(n.x(), n.y());
    if (across > kVertical) {
      const double next = std::atan2(n.x(), -n.y()) / kDeg;
      c = next + 360.0 * std::round((c - next) / 360.0);
    }
    poses.push_back({point.p_mm, std::atan2(across, n.z()) / kDeg, c});
  }
  return poses;
}

std::string writePoses(const std::vector<Pose>& poses) {
  std::string text;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose& pose = poses[i];
    text += fmt::format("{} X{:.4f} Y{:.4f} Z{:.4f} A{:.4f} C{:.4f}\n", i == 0 ? "G00" : "G01",
                        rounded(pose.p_mm.x()), rounded(pose.p_mm.y()), rounded(pose.p_mm.z()),
                        rounded(pose.a_deg), rounded(pose.c_deg));
  }
  return text;
}

}  // namespace kerfbench::planner
