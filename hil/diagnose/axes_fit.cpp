// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/axes_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Dense>
#include <Eigen/Geometry>

namespace kerfbench::diagnose {
namespace {

constexpr double kStation_mm = 0.5;
constexpr int kRounds = 25;
constexpr double kSettled = 1e-7;  // Change of a factor below which a round has brought nothing.
constexpr double kSlopeStep = 1e-4;
/// A cause leaves less than this share of the distance.
constexpr double kLeft = 0.2;
/// Another way that leaves less than so many times as much explains it as well.
constexpr double kAsGood = 3.0;
constexpr double kSmallestRest_mm = 0.01;  // Half a step and the flattening of curves.

/// The drawing as short straight lines.
class Drawing {
 public:
  Drawing(const dieline::Dieline& dieline, const PrintLayout& print) : print_(print) {
    for (const dieline::Entity& entity : dieline.entities) {
      if (entity.process == dieline::Process::kIgnore) continue;
      std::optional<Eigen::Vector2d> before;
      for (const double u : dieline::stations(entity.curve, kStation_mm)) {
        const Eigen::Vector2d p = dieline::pointAt(entity.curve, u);
        box_.extend(p);
        if (before) lines_.push_back({*before, p - *before});
        before = p;
      }
    }
  }
  [[nodiscard]] bool empty() const { return lines_.empty(); }
  [[nodiscard]] Eigen::Vector2d size_mm() const { return box_.sizes(); }

  /// From the nearest point of the drawing to one of the web, in the frame of unit 0.
  [[nodiscard]] Eigen::Vector2d awayFrom(Eigen::Vector2d p_mm) const {
    if (print_.pitch_mm > 0.0) {
      const double unit = std::round((box_.center().x() - p_mm.x()) / print_.pitch_mm);
      p_mm.x() += std::clamp(unit, 0.0, static_cast<double>(print_.units - 1)) * print_.pitch_mm;
    }
    Eigen::Vector2d away = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
    double least = std::numeric_limits<double>::max();
    for (const Line& line : lines_) {
      const Eigen::Vector2d from_start = p_mm - line.start;
      const double length2 = line.along.squaredNorm();
      const double u = length2 > 0.0 ? std::clamp(from_start.dot(line.along) / length2, 0.0, 1.0) : 0.0;
      const Eigen::Vector2d rest = from_start - u * line.along;
      if (rest.squaredNorm() < least) {
        least = rest.squaredNorm();
        away = rest;
      }
    }
    return away;
  }

 private:
  struct Line {
    Eigen::Vector2d start, along;
  };
  const PrintLayout& print_;
  std::vector<Line> lines_;
  Eigen::AlignedBox2d box_;
};

/// One way in which steps may have been made from those that belong there.
struct Way {
  bool swapped{};
  Eigen::Vector2d factor{Eigen::Vector2d::Ones()};

  /// Steps that belong there, for steps that were made.
  [[nodiscard]] Eigen::Vector2d undone(const Eigen::Vector2d& steps) const {
    const Eigen::Vector2d straight = swapped ? steps.reverse().eval() : steps;
    return straight.cwiseQuotient(factor);
  }
};

class Fitter {
 public:
  Fitter(const std::vector<LitInstant>& path, const PlaceOfSteps& place, const Drawing& drawing)
      : path_(path), place_(place), drawing_(drawing) {}

  /// RMS distance of the path, mapped back, from the drawing; infinite where a place is out of reach.
  [[nodiscard]] double distance_mm(const Way& way) const {
    double sum = 0.0;
    for (const LitInstant& instant : path_) {
      const std::optional<Eigen::Vector2d> p = onSheet(instant, way);
      if (!p) return std::numeric_limits<double>::infinity();
      sum += drawing_.awayFrom(*p).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(path_.size()));
  }

  /// Size of the path, mapped back, for that of the drawing: about the factors that are missing yet.
  [[nodiscard]] Eigen::Vector2d sizeRatio(const Way& way) const {
    Eigen::AlignedBox2d box;
    for (const LitInstant& instant : path_) {
      if (const std::optional<Eigen::Vector2d> p = onSheet(instant, way)) box.extend(*p);
    }
    return box.isEmpty() ? Eigen::Vector2d::Ones().eval()
                         : box.sizes().cwiseQuotient(drawing_.size_mm()).eval();
  }

  /// One step across the drawing: steps are whole, and along a straight line all are rounded alike.
  [[nodiscard]] Eigen::Vector2d rounding(const Way& way) const {
    Eigen::Vector2d share = Eigen::Vector2d::Zero();
    const std::optional<Eigen::Vector2d> from = place_(Eigen::Vector2d::Zero());
    for (const int axis : {0, 1}) {
      const std::optional<Eigen::Vector2d> to = place_(Eigen::Vector2d::Unit(axis));
      if (from && to) share[axis] = (*to - *from).norm() / drawing_.size_mm()[axis];
    }
    return share.cwiseProduct(way.factor.cwiseAbs());
  }

  /// Lets the factors of a way settle where the distance is least; `u` takes their expanded uncertainty.
  void refine(Way& way, Eigen::Vector2d& u) const {
    for (int round = 0; round < kRounds; ++round) {
      Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
      Eigen::Vector2d right = Eigen::Vector2d::Zero();
      double squares = 0.0;
      for (const LitInstant& instant : path_) addTo(normal, right, squares, instant, way);
      const Eigen::Matrix2d inverse = normal.ldlt().solve(Eigen::Matrix2d::Identity());
      const Eigen::Vector2d change = inverse * right;
      if (!change.allFinite()) return;
      way.factor = way.factor.cwiseQuotient(Eigen::Vector2d::Ones() + change);
      const double variance = squares / std::max<double>(1.0, static_cast<double>(path_.size()) - 2.0);
      const Eigen::Vector2d scatter =
          2.0 * (variance * inverse.diagonal().cwiseAbs()).cwiseSqrt().cwiseProduct(way.factor.cwiseAbs());
      u = scatter + rounding(way);
      if (change.cwiseAbs().maxCoeff() < kSettled) return;
    }
  }

 private:
  [[nodiscard]] std::optional<Eigen::Vector2d> onSheet(const LitInstant& instant, const Way& way) const {
    std::optional<Eigen::Vector2d> p = place_(way.undone(instant.steps));
    if (p) p->x() -= instant.sheet_x_mm;
    return p;
  }

  /// One instant's share of the normal equations for a relative change of both factors. Only what lies across
  /// the drawing's line counts: along it a point may slide.
  void addTo(Eigen::Matrix2d& normal, Eigen::Vector2d& right, double& squares, const LitInstant& instant,
             const Way& way) const {
    const std::optional<Eigen::Vector2d> p = onSheet(instant, way);
    if (!p) return;
    const Eigen::Vector2d away = drawing_.awayFrom(*p);
    const double distance = away.norm();
    squares += away.squaredNorm();
    if (!(distance > 0.0)) return;
    const Eigen::Vector2d across = away / distance;
    Eigen::Vector2d slope;
    for (const int axis : {0, 1}) {
      Way nudged = way;
      nudged.factor[axis] /= 1.0 + kSlopeStep;
      const std::optional<Eigen::Vector2d> moved = onSheet(instant, nudged);
      slope[axis] = moved ? (*moved - *p).dot(across) / kSlopeStep : 0.0;
    }
    normal += slope * slope.transpose();
    right -= slope * distance;
  }

  const std::vector<LitInstant>& path_;
  const PlaceOfSteps& place_;
  const Drawing& drawing_;
};

struct Found {
  Way way;
  Eigen::Vector2d u{Eigen::Vector2d::Zero()};
  double rest_mm{};
};

/// All ways with factors of one size, the plain one first.
std::vector<Way> turnedWays() {
  std::vector<Way> ways;
  for (const bool swapped : {false, true}) {
    for (const double y : {1.0, -1.0}) {
      for (const double x : {1.0, -1.0}) ways.push_back({swapped, {x, y}});
    }
  }
  return ways;
}

/// The way that alone explains the distance, if there is one among these.
std::optional<Found> onlyOne(std::vector<Found> ways, double before_mm, double left_mm) {
  std::ranges::sort(ways, {}, &Found::rest_mm);
  const double rest_mm = std::max(ways[0].rest_mm, kSmallestRest_mm);
  if (ways[0].rest_mm > std::min(kLeft * before_mm, left_mm)) return std::nullopt;
  if (ways.size() > 1 && ways[1].rest_mm < kAsGood * rest_mm) return std::nullopt;
  return ways[0];
}

std::string axisLetter(int axis) { return axis == 0 ? "X" : "Y"; }

}  // namespace

std::optional<AxesFit> fitAxes(const std::vector<LitInstant>& path, const PlaceOfSteps& place,
                               const dieline::Dieline& dieline, const PrintLayout& print,
                               const AxesFitOptions& options) {
  constexpr std::size_t kFewest = 20;
  const Drawing drawing(dieline, print);
  if (path.size() < kFewest || drawing.empty()) return std::nullopt;
  const Fitter fitter(path, place, drawing);
  const double before_mm = fitter.distance_mm(Way{});
  if (!(before_mm > options.worth_mm)) return std::nullopt;
  const auto fitOf = [&](const Found& found) {
    return AxesFit{found.way.swapped, found.way.factor, found.u, before_mm, found.rest_mm};
  };
  std::vector<Found> turned;
  for (const Way& way : turnedWays()) turned.push_back({way, {}, fitter.distance_mm(way)});
  if (const auto found = onlyOne(turned, before_mm, options.left_mm)) return fitOf(*found);
  if (!options.with_scale) return std::nullopt;
  for (Found& found : turned) {
    Found resized{{found.way.swapped, found.way.factor.cwiseProduct(fitter.sizeRatio(found.way))}, {}, 0.0};
    for (Found* start : {&found, &resized}) {
      const Eigen::Vector2d sense = start->way.factor;
      fitter.refine(start->way, start->u);
      // One that has turned an axis on the way is another of the eight.
      const bool same_way = (sense.array() * start->way.factor.array() > 0.0).all();
      start->rest_mm = same_way ? fitter.distance_mm(start->way) : std::numeric_limits<double>::infinity();
    }
    if (resized.rest_mm < found.rest_mm) found = resized;
  }
  // The plain way with another scale asks for less than one that turns an axis as well.
  if (const auto found = onlyOne({turned.front()}, before_mm, options.left_mm)) return fitOf(*found);
  if (const auto found = onlyOne(turned, before_mm, options.left_mm)) return fitOf(*found);
  return std::nullopt;
}

std::string sentenceOf(const AxesFit& fit, const std::array<AxisNames, 2>& names) {
  std::string text;
  const auto add = [&](const std::string& sentence) { text += (text.empty() ? "" : " ") + sentence; };
  if (fit.swapped)
    add(
        fmt::format("X and Y are swapped: exchange the pulses of {} and {} in the firmware, or their pins in "
                    "the machine file.",
                    names[0].axis, names[1].axis));
  for (const int axis : {0, 1}) {
    const AxisNames& name = names.at(static_cast<std::size_t>(axis));
    const double factor = fit.factor[axis];
    if (factor < 0.0)
      add(fmt::format(
          "{} runs backwards: invert DIR of {} in the firmware (Grbl: $3), or set `{}.dir_low` if "
          "the drive takes DIR low for forwards.",
          axisLetter(axis), name.axis, name.axis));
    const double off = std::abs(factor) - 1.0;
    if (fit.u_factor[axis] > 0.0 && std::abs(off) > fit.u_factor[axis])
      add(fmt::format(
          "{} moves {:.3f} ± {:.3f} % too {}: check the steps of {} for a mm ({} in the machine file, "
          "Grbl: ${}).",
          axisLetter(axis), 100.0 * std::abs(off), 100.0 * fit.u_factor[axis], off > 0.0 ? "far" : "little",
          name.axis, name.step, 100 + axis));
  }
  return text;
}

}  // namespace kerfbench::diagnose
