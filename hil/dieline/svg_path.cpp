// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/svg_path.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/svg_style.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;

class PathReader {
 public:
  PathReader(std::string_view data, double closing_tolerance)
      : scanner_(data), closing_tolerance_(closing_tolerance) {}

  SvgPath read() {
    char command = 0;
    while (!scanner_.atEnd()) {
      if (const auto letter = scanner_.letter()) {
        command = *letter;
      } else if (command == 0 || command == 'Z' || command == 'z' || !scanner_.atNumber()) {
        return broken();
      } else if (command == 'M' || command == 'm') {
        command = command == 'M' ? 'L' : 'l';  // More points behind a move are lines.
      }
      ++count_;
      if (count_ == 1 && command != 'M' && command != 'm') return broken();
      if (!step(command)) return broken();
    }
    return std::move(path_);
  }

 private:
  SvgPath broken() {
    path_.fault = fmt::format("path data is broken at character {}", scanner_.position() + 1);
    return std::move(path_);
  }

  bool step(char command) {
    const bool relative = command >= 'a';
    const char kind = relative ? static_cast<char>(command - 'a' + 'A') : command;
    if (kind == 'Z') {
      close();
    } else if (kind == 'M' || kind == 'L') {
      const auto to = point(relative);
      if (!to) return false;
      if (kind == 'L') emit(LineCurve{at_, *to});
      at_ = *to;
      if (kind == 'M') start_ = at_;
    } else if (kind == 'H' || kind == 'V') {
      const auto value = scanner_.number();
      if (!value) return false;
      Vector2d to = at_;
      double& axis = kind == 'H' ? to.x() : to.y();
      axis = relative ? axis + *value : *value;
      emit(LineCurve{at_, to});
      at_ = to;
    } else if (kind == 'A') {
      return arc(relative);
    } else {
      return bezier(kind, relative);
    }
    last_control_.reset();
    last_kind_ = kind;
    return true;
  }

  void close() {
    if ((at_ - start_).norm() > closing_tolerance_) emit(LineCurve{at_, start_});
    at_ = start_;
  }

  bool arc(bool relative) {
    const auto rx = scanner_.number();
    const auto ry = rx ? scanner_.number() : std::nullopt;
    const auto tilt = ry ? scanner_.number() : std::nullopt;
    const auto large = tilt ? scanner_.flag() : std::nullopt;
    const auto positive = large ? scanner_.flag() : std::nullopt;
    const auto to = positive ? point(relative) : std::nullopt;
    if (!to) return false;
    // The standard draws nothing between equal points.
    if (*to != at_) emit(svgArc(at_, {*rx, *ry, *tilt * std::numbers::pi / 180, *large, *positive}, *to));
    at_ = *to;
    last_control_.reset();
    last_kind_ = 'A';
    return true;
  }

  bool bezier(char kind, bool relative) {
    const bool cubic = kind == 'C' || kind == 'S';
    if (!cubic && kind != 'Q' && kind != 'T') return false;
    const bool was_same =
        cubic ? (last_kind_ == 'C' || last_kind_ == 'S') : (last_kind_ == 'Q' || last_kind_ == 'T');
    const Vector2d mirrored = was_same && last_control_ ? Vector2d(2 * at_ - *last_control_) : at_;
    std::optional<Vector2d> first = mirrored;
    if (kind == 'C' || kind == 'Q') first = point(relative);
    std::optional<Vector2d> second = first;
    if (first && cubic) second = point(relative);
    const auto to = second ? point(relative) : std::nullopt;
    if (!to) return false;
    BezierCurve curve;
    if (cubic) {
      curve.control_mm << at_, *first, *second, *to;
    } else {
      curve.control_mm << at_, (at_ + 2 * *first) / 3, (*to + 2 * *first) / 3, *to;
    }
    emit(curve);
    at_ = *to;
    last_control_ = second;
    last_kind_ = kind;
    return true;
  }

  std::optional<Vector2d> point(bool relative) {
    const auto x = scanner_.number();
    const auto y = x ? scanner_.number() : std::nullopt;
    if (!y) return std::nullopt;
    const Vector2d p(*x, *y);
    return relative ? Vector2d(at_ + p) : p;
  }

  void emit(Curve curve) { path_.curves.push_back({std::move(curve), count_}); }

  SvgScanner scanner_;
  double closing_tolerance_;
  SvgPath path_;
  Vector2d at_{Vector2d::Zero()};
  Vector2d start_{Vector2d::Zero()};
  std::optional<Vector2d> last_control_;
  char last_kind_{};
  std::size_t count_{};
};

}  // namespace

SvgPath readSvgPath(std::string_view data, double closing_tolerance) {
  return PathReader(data, closing_tolerance).read();
}

Curve svgArc(const Vector2d& from, const SvgArc& arc, const Vector2d& to) {
  double rx = std::abs(arc.rx);
  double ry = std::abs(arc.ry);
  if (rx == 0 || ry == 0) return LineCurve{from, to};
  const Eigen::Rotation2Dd tilt(arc.tilt_rad);
  const Vector2d half = tilt.inverse() * Vector2d((from - to) / 2);
  const double reach = std::pow(half.x() / rx, 2) + std::pow(half.y() / ry, 2);
  if (reach > 1) {
    rx *= std::sqrt(reach);
    ry *= std::sqrt(reach);
  }
  const double a = std::pow(rx * half.y(), 2) + std::pow(ry * half.x(), 2);
  const double factor =
      std::sqrt(std::max(0.0, (rx * rx * ry * ry - a) / a)) * (arc.large == arc.positive ? -1 : 1);
  const Vector2d centre_tilted(factor * rx * half.y() / ry, -factor * ry * half.x() / rx);
  const Vector2d centre = tilt * centre_tilted + (from + to) / 2;
  const auto angleOf = [&](const Vector2d& v) {
    return std::atan2((v.y() - centre_tilted.y()) / ry, (v.x() - centre_tilted.x()) / rx);
  };
  const double start = angleOf(half);
  double sweep = std::remainder(angleOf(-half) - start, 2 * std::numbers::pi);
  if (arc.positive && sweep < 0) sweep += 2 * std::numbers::pi;
  if (!arc.positive && sweep > 0) sweep -= 2 * std::numbers::pi;
  if (std::abs(rx - ry) <= 1e-12 * rx) return ArcCurve{centre, rx, arc.tilt_rad + start, sweep};
  return EllipseCurve{centre, tilt * Vector2d(rx, 0), tilt * Vector2d(0, ry), start, sweep};
}

}  // namespace kerfbench::dieline
