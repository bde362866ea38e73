// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/reversal.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "hil/calibrate/head/observation.h"
#include "hil/calibrate/head/rigid.h"
#include "hil/calibrate/head/spread.h"

namespace kerfbench::calibrate {
namespace {

constexpr std::size_t kLeastCommon = 5;
constexpr double kMostMissPriors =
    10.0;  // Multiple of the median mark's prior, as it is between two rigid views.
constexpr int kShear = 2;

std::string powerName(int u, int v) {
  const auto one = [](const char* name, int power) -> std::string {
    if (power == 0) return "";
    return power == 1 ? name : fmt::format("{}^{}", name, power);
  };
  return one("x", u) + (u > 0 && v > 0 ? " " : "") + one("y", v);
}

void check(const ReversalOptions& options) {
  std::string faults;
  if (options.camera_field_mm.isEmpty() || !(options.camera_field_mm.sizes().minCoeff() > 0.0))
    faults += "options.camera_field_mm must not be empty; ";
  if (options.degree < 1 || options.degree > 5) faults += "options.degree must be 1 … 5; ";
  if (!(options.prior_mm > 0.0)) faults += "options.prior_mm must be above 0; ";
  if (!(options.rejection_chance > 0.0 && options.rejection_chance < 1.0))
    faults += "options.rejection_chance must be in (0, 1); ";
  if (!(options.most_false_share >= 0.0 && options.most_false_share < 0.5))
    faults += "options.most_false_share must be in [0, 0.5); ";
  if (!faults.empty()) throw std::invalid_argument(faults.substr(0, faults.size() - 2));
}

}  // namespace

CameraError::CameraError(const ReversalOptions& options) : field_mm_(options.camera_field_mm) {
  const auto add = [&](const Power& power, std::string name, int degree) {
    powers_.push_back(power);
    terms_.push_back({std::move(name), degree, 0.0, 0.0, false});
  };
  add({1, 0, 0}, "dx: x", 1);
  add({0, 1, 1}, "dy: y", 1);
  add({1, 1, kShear}, "shear", 1);
  for (int degree = 2; degree <= options.degree; ++degree) {
    for (int axis = 0; axis < 2; ++axis) {
      for (int u = degree; u >= 0; --u) {
        add({u, degree - u, axis}, (axis == 0 ? "dx: " : "dy: ") + powerName(u, degree - u), degree);
      }
    }
  }
}

Eigen::Matrix2Xd CameraError::movesAt(const Eigen::Vector2d& p_C_mm) const {
  const Eigen::Vector2d half_mm = 0.5 * field_mm_.sizes();
  const Eigen::Vector2d at = (p_C_mm - field_mm_.center()).cwiseQuotient(half_mm);
  Eigen::Matrix2Xd moves = Eigen::Matrix2Xd::Zero(2, static_cast<Eigen::Index>(powers_.size()));
  for (std::size_t k = 0; k < powers_.size(); ++k) {
    const Power& power = powers_[k];
    auto move = moves.col(static_cast<Eigen::Index>(k));
    if (power.axis == kShear) {
      // dx = g y, dy = g x: no turn in it, whatever the sides of the field.
      move = Eigen::Vector2d(half_mm.y() * at.y(), half_mm.x() * at.x()) / half_mm.maxCoeff();
    } else {
      move[power.axis] = std::pow(at.x(), power.u) * std::pow(at.y(), power.v);
    }
  }
  return moves;
}

void CameraError::set(const Eigen::VectorXd& values_mm, const Eigen::MatrixXd& covariance_mm2,
                      double prior_mm) {
  values_mm_ = values_mm;
  covariance_mm2_ = covariance_mm2;
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    terms_[k].value_mm = values_mm[row];
    terms_[k].sigma_mm = std::sqrt(covariance_mm2(row, row));
    terms_[k].held = terms_[k].sigma_mm < kHeldShare * prior_mm;
  }
}

Eigen::Vector2d CameraError::at_mm(const Eigen::Vector2d& p_C_mm) const {
  return movesAt(p_C_mm) * values_mm_;
}

Eigen::Matrix2d CameraError::covarianceAt_mm2(const Eigen::Vector2d& p_C_mm) const {
  const Eigen::Matrix2Xd moves = movesAt(p_C_mm);
  return moves * covariance_mm2_ * moves.transpose();
}

/// The steps of separateCamera(). Unknowns: the camera's terms, then turn and shift of each view but the
/// first.
class Reversal {
 public:
  Reversal(std::span<const SheetView> views, const ReversalOptions& options)
      : views_(views),
        options_(options),
        camera_(options),
        X_CS_(views.size(), Eigen::Isometry2d::Identity()) {}

  ReversalResult separate() {
    sortMarks();
    placeViews();
    for (int pass = 0; pass < kMostPasses; ++pass) {
      for (int step = 0; step < kSteps; ++step) solve();
      if (!judge()) return result();
    }
    throw HeadCalibrationError("the views contradict each other: no set of marks agrees");
  }

 private:
  static constexpr int kMostPasses = 30;
  static constexpr int kSteps = 3;  // Gauss and Newton: only the small turns are not linear.

  struct Sighting {
    std::size_t view{};
    Eigen::Vector2d p_C_mm;
    Eigen::Matrix2d covariance_mm2;
  };
  struct Mark {
    int id{};
    std::vector<Sighting> sightings;  ///< The first one is compared with the others.
    bool used{true};
  };
  /// A sighting carried to the sheet as it lay in the first view.
  struct OnSheet {
    Eigen::Vector2d p_mm;
    Eigen::Matrix2Xd by_unknowns;
    Eigen::Matrix2d covariance_mm2;
  };
  /// All sightings of a mark less the first: zero but for noise.
  struct Differences {
    Eigen::VectorXd off_mm;
    Eigen::MatrixXd by_unknowns, covariance_mm2;
  };

  [[nodiscard]] Eigen::Index termCount() const { return static_cast<Eigen::Index>(camera_.terms().size()); }
  [[nodiscard]] Eigen::Index unknownCount() const {
    return termCount() + 3 * static_cast<Eigen::Index>(views_.size() - 1);
  }
  void sortMarks();
  void placeViews();
  [[nodiscard]] OnSheet onSheet(const Sighting& sighting) const;
  [[nodiscard]] Differences differencesOf(const Mark& mark) const;
  void solve();
  bool judge();
  [[nodiscard]] ReversalResult result() const;

  std::span<const SheetView> views_;
  ReversalOptions options_;
  CameraError camera_;
  std::vector<Eigen::Isometry2d> X_CS_;
  std::vector<Mark> marks_;
  Eigen::VectorXd values_mm_;
  Eigen::MatrixXd covariance_;
  double chi2_{}, freedom_{};
};

void Reversal::sortMarks() {
  std::map<int, Mark> by_id;
  std::string faults;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    for (const SeenMark& seen : views_[v].marks) {
      const auto complain = [&](const char* what) {
        faults += fmt::format("mark {} of view '{}' {}\n", seen.id, views_[v].name, what);
      };
      if (!seen.p_mm.allFinite() || !isCovariance(seen.covariance_mm2)) {
        complain("is not finite or has no positive covariance");
        continue;
      }
      if (!options_.camera_field_mm.contains(seen.p_mm)) complain("is out of the camera's field");
      Mark& mark = by_id[seen.id];
      mark.id = seen.id;
      if (!mark.sightings.empty() && mark.sightings.back().view == v) complain("is there twice");
      mark.sightings.push_back({v, seen.p_mm, seen.covariance_mm2});
    }
  }
  if (!faults.empty()) throw HeadCalibrationError(faults.substr(0, faults.size() - 1));
  for (auto& [id, mark] : by_id) marks_.push_back(std::move(mark));
}

void Reversal::placeViews() {
  std::string faults;
  for (std::size_t v = 1; v < views_.size(); ++v) {
    std::vector<PlacePair> pairs;
    for (const Mark& mark : marks_) {
      if (mark.sightings.front().view != 0) continue;
      for (const Sighting& s : mark.sightings) {
        if (s.view == v) pairs.emplace_back(mark.sightings.front().p_C_mm, s.p_C_mm);
      }
    }
    if (pairs.size() < kLeastCommon) {
      faults += fmt::format("view '{}' shares {} marks with '{}', it takes {}\n", views_[v].name,
                            pairs.size(), views_[0].name, kLeastCommon);
      continue;
    }
    const RigidMotion motion = rigidMotion(pairs);
    X_CS_[v] = motion.X;
    if (motion.median_miss_mm > kMostMissPriors * options_.prior_mm) {
      faults +=
          fmt::format("view '{}' is no turn and shift of '{}': half of the marks are off by {:.3f} mm\n",
                      views_[v].name, views_[0].name, motion.median_miss_mm);
    }
  }
  if (!faults.empty()) throw HeadCalibrationError(faults.substr(0, faults.size() - 1));
}

Reversal::OnSheet Reversal::onSheet(const Sighting& sighting) const {
  const Eigen::Isometry2d X_SC = X_CS_[sighting.view].inverse();
  const Eigen::Matrix2Xd moves = camera_.movesAt(sighting.p_C_mm);
  OnSheet on;
  on.p_mm = X_SC * sighting.p_C_mm;
  on.by_unknowns = Eigen::Matrix2Xd::Zero(2, unknownCount());
  on.by_unknowns.leftCols(termCount()) = -X_SC.linear() * moves;
  if (sighting.view > 0) {
    const auto first = termCount() + 3 * static_cast<Eigen::Index>(sighting.view - 1);
    on.by_unknowns.col(first) = Eigen::Vector2d(-on.p_mm.y(), on.p_mm.x());
    on.by_unknowns.middleCols<2>(first + 1).setIdentity();
  }
  on.covariance_mm2 = X_SC.linear() * sighting.covariance_mm2 * X_SC.linear().transpose();
  return on;
}

Reversal::Differences Reversal::differencesOf(const Mark& mark) const {
  const OnSheet first = onSheet(mark.sightings.front());
  const auto n = 2 * static_cast<Eigen::Index>(mark.sightings.size() - 1);
  Differences d{Eigen::VectorXd(n), Eigen::MatrixXd(n, unknownCount()),
                first.covariance_mm2.replicate(n / 2, n / 2)};
  for (Eigen::Index k = 0; k < n; k += 2) {
    const OnSheet next = onSheet(mark.sightings[static_cast<std::size_t>(k / 2 + 1)]);
    d.off_mm.segment<2>(k) = next.p_mm - first.p_mm;
    d.by_unknowns.middleRows<2>(k) = next.by_unknowns - first.by_unknowns;
    d.covariance_mm2.block<2, 2>(k, k) += next.covariance_mm2;
  }
  return d;
}

void Reversal::solve() {
  const double prior = 1.0 / (options_.prior_mm * options_.prior_mm);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknownCount(), unknownCount());
  normal.diagonal().head(termCount()).setConstant(prior);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknownCount());
  for (const Mark& mark : marks_) {
    if (!mark.used || mark.sightings.size() < 2) continue;
    const Differences d = differencesOf(mark);
    const Eigen::MatrixXd weighted = d.covariance_mm2.llt().solve(d.by_unknowns);
    normal += d.by_unknowns.transpose() * weighted;
    gradient -= weighted.transpose() * d.off_mm;
  }
  const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
  const Eigen::VectorXd unknowns = factor.solve(gradient);
  covariance_ = factor.solve(Eigen::MatrixXd::Identity(unknownCount(), unknownCount()));
  values_mm_ = unknowns.head(termCount());
  for (std::size_t v = 1; v < views_.size(); ++v) {
    const auto first = termCount() + 3 * static_cast<Eigen::Index>(v - 1);
    // The unknowns turn and shift on the sheet.
    const Eigen::Isometry2d X_SS =
        Eigen::Translation2d(unknowns.segment<2>(first + 1)) * Eigen::Rotation2Dd(unknowns[first]);
    X_CS_[v] = X_CS_[v] * X_SS.inverse();
  }
}

bool Reversal::judge() {
  const double limit_chance = options_.rejection_chance / static_cast<double>(marks_.size());
  chi2_ = freedom_ = 0.0;
  bool changed = false;
  std::size_t rejected = 0;
  for (Mark& mark : marks_) {
    if (mark.sightings.size() < 2) continue;
    Differences d = differencesOf(mark);
    // The poses were moved on by the solution, so that only the camera's part of it is left to apply.
    const Eigen::VectorXd off = d.off_mm + d.by_unknowns.leftCols(termCount()) * values_mm_;
    const Eigen::MatrixXd fitted = d.by_unknowns * covariance_ * d.by_unknowns.transpose();
    const Eigen::MatrixXd expected =
        mark.used ? Eigen::MatrixXd(d.covariance_mm2 - fitted) : Eigen::MatrixXd(d.covariance_mm2 + fitted);
    const double distance2 = off.dot(expected.ldlt().solve(off));
    const auto n = static_cast<double>(off.size());
    // Chi-square of n degrees lies above n/2 times that of two with less than this chance.
    const bool use = distance2 <= 0.5 * n * chiSquare2Above(limit_chance);
    changed = changed || use != mark.used;
    mark.used = use;
    if (!use) {
      ++rejected;
      continue;
    }
    chi2_ += off.dot(d.covariance_mm2.llt().solve(off));
    freedom_ += n - d.covariance_mm2.llt().solve(fitted).trace();
  }
  if (static_cast<double>(rejected) >
      std::max(1.0, options_.most_false_share * static_cast<double>(marks_.size()))) {
    throw HeadCalibrationError(
        fmt::format("{} of {} marks are elsewhere in one view than in another", rejected, marks_.size()));
  }
  return changed;
}

ReversalResult Reversal::result() const {
  ReversalResult result{camera_, {}, X_CS_};
  result.camera.set(values_mm_, covariance_.topLeftCorner(termCount(), termCount()), options_.prior_mm);
  result.noise_ratio = freedom_ >= 1.0 ? std::sqrt(chi2_ / freedom_) : 1.0;
  for (const Mark& mark : marks_) {
    if (!mark.used) {
      ++result.rejected;
      continue;
    }
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Sighting& sighting : mark.sightings) {
      const OnSheet on = onSheet(sighting);
      const Eigen::Matrix2d weight = on.covariance_mm2.inverse();
      information += weight;
      sum += weight * (on.p_mm + on.by_unknowns.leftCols(termCount()) * values_mm_);
    }
    const Eigen::Matrix2d covariance = information.inverse();
    result.marks.push_back({mark.id, covariance * sum, 0.5 * (covariance + covariance.transpose())});
  }
  return result;
}

ReversalResult separateCamera(std::span<const SheetView> views, const ReversalOptions& options) {
  check(options);
  if (views.empty()) throw HeadCalibrationError("there is no view of the sheet");
  return Reversal(views, options).separate();
}

}  // namespace kerfbench::calibrate
