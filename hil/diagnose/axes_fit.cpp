// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/axes_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Dense>
#include <Eigen/Geometry>

#include "hil/diagnose/drawing.h"

namespace kerfbench::diagnose {
namespace {

constexpr int kRounds = 25;
constexpr double kSettled = 1e-7;  // Change of a factor below which a round has brought nothing.
constexpr double kSlopeStep = 1e-4;
constexpr double kLongestChange = 0.3;  // A factor changes by no more in one round: far off, slopes mislead.
/// A cause leaves less than this share of the distance.
constexpr double kLeft = 0.2;
/// Another way that leaves less than so many times as much explains it as well.
constexpr double kAsGood = 3.0;
constexpr double kSmallestRest_mm = 0.01;  // Half a step and the flattening of curves.
constexpr double kLargestFactor = 5.0;     // No machine is set up by more.
/// A way whose factors are so many times nearer to 1 than those of another is the likelier one.
constexpr double kPlainer = 3.0;
constexpr double kSmallestLog = 1e-3;
/// Share of the drawing's width and height that a path must have, or nothing is known of what lies beyond.
constexpr double kCovered = 0.95;
// A round that leaves more than this share of the distance is no progress, after so many.
constexpr double kStalled = 0.9;
constexpr int kPatience = 4;

/// One way in which steps may have been made from those that belong there.
struct Way {
  bool swapped{};
  Eigen::Vector2d factor{Eigen::Vector2d::Ones()};

  /// How far the factors are from 1, as a logarithm.
  [[nodiscard]] double strangeness() const {
    return std::max(kSmallestLog, factor.cwiseAbs().array().log().abs().maxCoeff());
  }

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

  /// Size of the path, mapped back, for that of the drawing: about the factors that are missing yet. 1 where
  /// either has no size.
  [[nodiscard]] Eigen::Vector2d sizeRatio(const Way& way) const {
    const Eigen::Vector2d ratio = size_mm(way).cwiseQuotient(drawing_.size_mm());
    return ratio.allFinite() && ratio.minCoeff() > 0.0 ? ratio : Eigen::Vector2d::Ones().eval();
  }

  /// Whether the path, mapped back, is as wide and as high as the drawing.
  [[nodiscard]] bool covers(const Way& way) const {
    return (size_mm(way).array() >= kCovered * drawing_.size_mm().array()).all();
  }

  /// RMS distance that is left if the path as it is may be shifted.
  [[nodiscard]] double distanceShifted_mm() const {
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    double rms_mm = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
      Eigen::Matrix2d normal = 1e-9 * Eigen::Matrix2d::Identity();
      Eigen::Vector2d right = Eigen::Vector2d::Zero();
      double squares = 0.0;
      for (const LitInstant& instant : path_) {
        const std::optional<Eigen::Vector2d> p = onSheet(instant, Way{});
        if (!p) return rms_mm;
        const Eigen::Vector2d away = drawing_.awayFrom(*p + shift);
        squares += away.squaredNorm();
        const Eigen::Vector2d across = away.stableNormalized();
        normal += across * across.transpose();
        right -= away;
      }
      rms_mm = std::min(rms_mm, std::sqrt(squares / static_cast<double>(path_.size())));
      shift += normal.ldlt().solve(right);
    }
    return rms_mm;
  }

  /// Distance that whole steps leave: half of the longer one.
  [[nodiscard]] double halfStep_mm() const { return 0.5 * longestStep_mm(place_); }

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
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
      Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
      Eigen::Vector2d right = Eigen::Vector2d::Zero();
      double squares = 0.0;
      for (const LitInstant& instant : path_) addTo(normal, right, squares, instant, way);
      const Eigen::Matrix2d inverse = normal.ldlt().solve(Eigen::Matrix2d::Identity());
      const Eigen::Vector2d change = (inverse * right).cwiseMax(-kLongestChange).cwiseMin(kLongestChange);
      if (!change.allFinite()) return;
      if (round > kPatience && squares > kStalled * before && change.cwiseAbs().maxCoeff() > kSlopeStep)
        return;
      before = squares;
      way.factor = way.factor.cwiseQuotient(Eigen::Vector2d::Ones() + change);
      const double variance = squares / std::max<double>(1.0, static_cast<double>(path_.size()) - 2.0);
      const Eigen::Vector2d scatter =
          2.0 * (variance * inverse.diagonal().cwiseAbs()).cwiseSqrt().cwiseProduct(way.factor.cwiseAbs());
      u = scatter + rounding(way);
      if (change.cwiseAbs().maxCoeff() < kSettled) return;
    }
  }

 private:
  [[nodiscard]] Eigen::Vector2d size_mm(const Way& way) const {
    Eigen::AlignedBox2d box;
    for (const LitInstant& instant : path_) {
      if (const std::optional<Eigen::Vector2d> p = onSheet(instant, way)) box.extend(*p);
    }
    return box.isEmpty() ? Eigen::Vector2d::Zero().eval() : box.sizes().eval();
  }

  [[nodiscard]] std::optional<Eigen::Vector2d> onSheet(const LitInstant& instant, const Way& way) const {
    std::optional<Eigen::Vector2d> p = place_(way.undone(instant.steps));
    if (!p || !p->allFinite()) return std::nullopt;
    p->x() -= instant.sheet_x_mm;
    return drawing_.inUnit(*p);
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
  [[nodiscard]] bool isSane() const {
    const Eigen::Array2d size = way.factor.cwiseAbs().array();
    return u.allFinite() && size.maxCoeff() < kLargestFactor && size.minCoeff() > 1.0 / kLargestFactor;
  }
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

/// The way that alone explains the distance, if there is one among these: no other does as well, or all that
/// do have factors much farther from 1. Of two with the same factors the one without a turn is plainer.
std::optional<Found> onlyOne(const std::vector<Found>& ways, double before_mm, double left_mm) {
  double best_mm = std::numeric_limits<double>::infinity();
  for (const Found& found : ways)
    if (found.isSane()) best_mm = std::min(best_mm, std::max(kSmallestRest_mm, found.rest_mm));
  std::vector<Found> good;
  for (const Found& found : ways) {
    const bool explains = found.isSane() && found.rest_mm <= std::min(kLeft * before_mm, left_mm);
    if (explains && found.rest_mm < kAsGood * best_mm) good.push_back(found);
  }
  if (good.empty()) return std::nullopt;
  const auto plainest =
      std::ranges::min_element(good, {}, [](const Found& f) { return f.way.strangeness(); });
  const bool is_unturned = !plainest->way.swapped && plainest->way.factor.minCoeff() > 0.0;
  for (const Found& other : good) {
    const bool is_far = other.way.strangeness() >= kPlainer * plainest->way.strangeness();
    if (&other != &*plainest && !is_far && !is_unturned) return std::nullopt;
  }
  return *plainest;
}

/// Lets the factors of each way settle, from 1 and from the sizes of path and drawing.
void scaleAll(std::vector<Found>& ways, const Fitter& fitter) {
  for (Found& found : ways) {
    Found resized{{found.way.swapped, found.way.factor.cwiseProduct(fitter.sizeRatio(found.way))},
                  Eigen::Vector2d::Zero(),
                  0.0};
    for (Found* start : {&found, &resized}) {
      const Eigen::Vector2d sense = start->way.factor;
      fitter.refine(start->way, start->u);
      // One that has turned an axis on the way is another of the eight.
      const bool same_way = (sense.array() * start->way.factor.array() > 0.0).all();
      start->rest_mm = same_way ? fitter.distance_mm(start->way) : std::numeric_limits<double>::infinity();
    }
    if (resized.rest_mm < found.rest_mm) found = resized;
  }
}

std::string axisLetter(int axis) { return axis == 0 ? "X" : "Y"; }

}  // namespace

double longestStep_mm(const PlaceOfSteps& place) {
  double longest_mm = 0.0;
  const std::optional<Eigen::Vector2d> from = place(Eigen::Vector2d::Zero());
  for (const int axis : {0, 1}) {
    const std::optional<Eigen::Vector2d> to = place(Eigen::Vector2d::Unit(axis));
    if (from && to) longest_mm = std::max(longest_mm, (*to - *from).norm());
  }
  return longest_mm;
}

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
  const auto told = [&](const std::optional<Found>& found) {
    return found && fitter.covers(found->way) ? std::optional(fitOf(*found)) : std::nullopt;
  };
  std::vector<Found> turned;
  for (const Way& way : turnedWays())
    turned.push_back({way, Eigen::Vector2d::Zero(), fitter.distance_mm(way)});
  if (const auto found = onlyOne(turned, before_mm, options.left_mm)) return told(found);
  if (!options.with_scale) return std::nullopt;
  scaleAll(turned, fitter);
  const std::optional<Found> scaled = onlyOne(turned, before_mm, options.left_mm);
  // A turn fits or it does not; a scale has been fitted, and a shift may fit as well.
  const bool is_shift =
      scaled && fitter.distanceShifted_mm() < kAsGood * std::max(scaled->rest_mm, fitter.halfStep_mm());
  return is_shift ? std::nullopt : told(scaled);
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
