// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/library.h"

#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/base/yaml_reader.h"

namespace kerfbench::planner {
namespace {

using base::YamlReader;

/// Largest value, beyond every material and laser; keeps all computed numbers finite.
constexpr double kMost = 1e6;
constexpr std::size_t kMostPoints = 1000;
constexpr int kMostNumber = 99999;
constexpr double kAllPercent = 100.0;

std::string shortText(YamlReader& file, const char* key, const char* fallback) {
  std::string text =
      fallback == nullptr ? file.text(key) : file.text(key, std::optional<std::string>(fallback));
  if (text.size() > 500) {
    file.fault(key, "is longer than 500 characters");
    text.clear();
  }
  return text;
}

int numberOf(YamlReader& file) {
  if (!file.has("number")) return 0;
  return static_cast<int>(file.integer("number", {.min = 1, .max = kMostNumber}));
}

struct Read {
  std::vector<Curve::Point> points;
  bool sound{true};
};

bool isNumber(YamlReader& row, const char* key) {
  if (!row.has(key)) return false;
  const std::string text = row.text(key);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end != text.c_str() && std::isfinite(value);
}

/// Reads the points, each with its own line. A value that is no number is reported once, and not compared
/// with its neighbours.
Read readPoints(YamlReader& file, const char* x_key, const char* y_key, double most_x = kMost) {
  std::vector<YamlReader> rows = file.list("points");
  if (rows.size() < 2 || rows.size() > kMostPoints) {
    file.fault("points", fmt::format("{} of them; a curve has 2 to {}: '- {{{}: …, {}: …}}'", rows.size(),
                                     kMostPoints, x_key, y_key));
  }
  Read read{{}, rows.size() >= 2 && rows.size() <= kMostPoints};
  if (rows.size() > kMostPoints) return read;
  std::optional<double> x_before, y_before;
  for (YamlReader& row : rows) {
    const auto next = [&](const char* key, double most, std::optional<double>& before) {
      const bool comparable = isNumber(row, key);
      const double now = row.number(key, {.min = 0.0, .max = most});
      if (!comparable || now < 0.0 || now > most) {
        read.sound = false;
        return now;
      }
      if (before && now <= *before) {
        row.fault(key, fmt::format("{:g} does not rise above {:g}, that of the point before", now, *before));
        read.sound = false;
      }
      before = now;
      return now;
    };
    const double x = next(x_key, most_x, x_before);
    read.points.push_back({x, next(y_key, kMost, y_before)});
  }
  return read;
}

YamlReader opened(const std::filesystem::path& path, const char* kind) {
  YamlReader file = YamlReader::openFile(path);
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  (void)file.choice("kind", {kind});
  return file;
}

/// Replaces points with faults: finish() refuses the file.
Curve curveOf(const Read& read) { return read.sound ? Curve(read.points) : Curve(); }

}  // namespace

Material readMaterial(const std::filesystem::path& path) try {
  YamlReader file = opened(path, "material");
  Material material;
  material.number = numberOf(file);
  material.name = shortText(file, "name", nullptr);
  material.source = shortText(file, "source", "");
  YamlReader units = file.section("units");
  (void)units.choice("power_per_area", {"J/mm2"});
  (void)units.choice("depth", {"mm"});
  const Read read = readPoints(file, "power_per_area", "depth");
  if (!read.points.empty() && read.points.front().y != 0.0)
    file.fault("points", "the first must be where cutting begins, at depth 0");
  material.depth = curveOf(read);
  file.finish();
  return material;
} catch (const base::ConfigError& error) {
  throw PowerError(error.what());
}

LaserTube readLaser(const std::filesystem::path& path) try {
  YamlReader file = opened(path, "laser");
  LaserTube laser;
  laser.number = numberOf(file);
  laser.name = shortText(file, "name", nullptr);
  laser.source = shortText(file, "source", "");
  YamlReader units = file.section("units");
  laser.control_unit = units.choice("control", {"%", "V"});
  (void)units.choice("power", {"W"});
  const Read read = readPoints(file, "control", "power", laser.control_unit == "%" ? kAllPercent : kMost);
  laser.full_control = file.number("full_control", {.min = 1e-3, .max = kMost});
  laser.power = curveOf(read);
  const double low_w = laser.power.least().y;
  const double high_w = laser.power.greatest().y;
  laser.least_w = file.number("least_power_w", {.min = 0.0, .max = kMost, .fallback = low_w});
  laser.most_w = file.number("most_power_w", {.min = 0.0, .max = kMost, .fallback = high_w});
  const auto inside = [&](const char* key, double value) {
    if (read.sound && file.has(key) && !(value >= low_w && value <= high_w))
      file.fault(key, fmt::format("{:g} W is outside the curve's {:g} … {:g} W", value, low_w, high_w));
  };
  inside("least_power_w", laser.least_w);
  inside("most_power_w", laser.most_w);
  if (!(laser.least_w < laser.most_w)) file.fault("most_power_w", "must be above least_power_w");
  if (read.sound && laser.power.greatest().x > laser.full_control)
    file.fault("full_control", fmt::format("{:g} is below the curve's last point, {:g}", laser.full_control,
                                           laser.power.greatest().x));
  file.finish();
  return laser;
} catch (const base::ConfigError& error) {
  throw PowerError(error.what());
}

}  // namespace kerfbench::planner
