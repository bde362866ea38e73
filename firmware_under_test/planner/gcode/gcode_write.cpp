// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "firmware_under_test/planner/gcode/gcode.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

double rounded(double value_mm) {
  return std::round(value_mm * 1e4) / 1e4 + 0.0;  // + 0.0 turns -0 into 0
}
Vector2d rounded(const Vector2d& p_mm) { return {rounded(p_mm.x()), rounded(p_mm.y())}; }

std::string zWord(double z) { return fmt::format("Z{:g}", rounded(z)); }

std::string commentOf(const Segment& segment, const std::function<std::string(int entity)>& name_of) {
  if (segment.entity < 0) return {};
  const std::string name = name_of(segment.entity);
  return fmt::format(" (E{}{}{})", segment.entity, name.empty() ? "" : " ", name);
}

const char* headingOf(const Segment& segment) {
  if (!segment.isArc()) return "LINE";
  return segment.isCircle() ? "CIRCLE" : "ARC";
}

}  // namespace

std::string writeGcode(const std::vector<std::vector<Segment>>& pieces,
                       const std::vector<std::string>& names) {
  return writeGcode(pieces, [&](int entity) { return names.at(std::size_t(entity)); });
}

std::string writeGcode(const std::vector<std::vector<Segment>>& pieces,
                       const std::function<std::string(int entity)>& name_of) {
  std::string text;
  std::optional<Vector2d> at;
  for (const std::vector<Segment>& piece : pieces) {
    std::string heading;
    for (const Segment& segment : piece) {
      const Vector2d start = rounded(segment.start_mm);
      const Vector2d end = rounded(segment.end_mm);
      const std::string comment = commentOf(segment, name_of);
      // A line shorter than the last decimal is left out: its neighbours meet there anyway.
      if (start == end && std::abs(segment.sweep_rad) < std::numbers::pi) continue;
      // Ends within 2 um are joined by the next line itself.
      const bool jump = !at || (start - *at).norm() > 0.002;
      if (heading != headingOf(segment) || jump) {
        heading = headingOf(segment);
        text += heading + "\n";
      }
      if (jump) {
        text += fmt::format("G00 X{:.4f} Y{:.4f} Z0{}\n", start.x(), start.y(), comment);
        at = start;
      }
      if (segment.isArc()) {
        const Vector2d ij = rounded(segment.centre_mm - *at);
        const Vector2d to = segment.isCircle() ? *at : end;
        text +=
            fmt::format("{} X{:.4f} Y{:.4f} I{:.4f} J{:.4f} {}{}\n", segment.sweep_rad > 0.0 ? "G03" : "G02",
                        to.x(), to.y(), ij.x(), ij.y(), zWord(segment.z), comment);
        at = to;
      } else {
        text += fmt::format("G01 X{:.4f} Y{:.4f} {}{}\n", end.x(), end.y(), zWord(segment.z), comment);
        at = end;
      }
    }
  }
  return text;
}

}  // namespace kerfbench::planner
