// SPDX-License-Identifier: Apache-2.0
// HeadFitter: from marks as measured to where Gauss and Newton begin.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <Eigen/Cholesky>

#include "hil/calibrate/head/head_fitter.h"
#include "hil/calibrate/head/spread.h"
#include "twin/base/statistics.h"

namespace kerfbench::calibrate {
namespace {

constexpr std::size_t kMarksToBegin = 64;  // From which the others can be judged.
constexpr double kStartShare =
    1e-4;  // Share of the field: marks of micrometres would hold the start where it is.
constexpr int kMostRobustPasses = 30;
constexpr int kMostIterations = 50;
constexpr int kRoughIterations = 5;
constexpr double kFarInMisses = 10.0;  // Multiple of the median mark's miss: such a mark is of another place.
constexpr double kFarInSigmas = 8.0;   // Multiple of the median mark's sigma under Cauchy's loss.
constexpr double kAreaMargin = 0.03;   // A table has one of 0.02.

Eigen::Matrix2d whiteningOf(const Eigen::Matrix2d& covariance) {
  return covariance.llt().matrixL().solve(Eigen::Matrix2d::Identity());
}

/// `most` of the marks or all, by the golden section: in rows they come in order, and none may be favoured.
std::vector<WeighedMark> spreadOver(const std::vector<WeighedMark>& marks, std::size_t most) {
  if (marks.size() <= most) return marks;
  const double share = static_cast<double>(most) / static_cast<double>(marks.size());
  std::vector<WeighedMark> some;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const double turns = std::numbers::phi * static_cast<double>(i);
    if (turns - std::floor(turns) < share) some.push_back(marks[i]);
  }
  return some;
}

}  // namespace

void HeadFitter::weighMarks() {
  const AxisFinding axes = identifyAxes(observations_);
  if (!axes.map.asTold() && !options_.accept_axes) {
    throw HeadCalibrationError(
        axes.map.words() +
        ". A table would hide what is a fault of the wiring, of the drives' directions "
        "or of how the sheet lay under the camera: mend that, or accept the axes");
  }
  axes_ = axes.map;
  unmodelled_mm_ = options_.tolerances.unmodelled_share * areaOfAims().sizes().maxCoeff();
  for (const HeadObservation& o : observations_) {
    Eigen::Matrix2d noise = o.covariance_mm2;
    if (options_.round_steps) {
      const Eigen::Matrix2d turned = axes_.matrix();
      noise += turned * nominal_.roundingCovariance_mm2(o.aim_W_mm) * turned.transpose();
    }
    noise_mm2_.push_back(noise);
    marks_.push_back({axes_.matrix() * nominal_.angles_rad(o.aim_W_mm), o.measured_W_mm, whiteningOf(noise)});
  }
  gatherShared();
}

void HeadFitter::gatherShared() {
  std::map<int, Eigen::Index> columns;
  for (const HeadObservation& o : observations_) {
    if (o.shared) columns.try_emplace(o.shared->sheet, 3 * static_cast<Eigen::Index>(columns.size()));
  }
  shared_ = Eigen::MatrixXd::Zero(2 * static_cast<Eigen::Index>(marks_.size()),
                                  3 * static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    const std::optional<SharedError>& shared = observations_[i].shared;
    if (!shared) continue;
    shared_.block<2, 3>(2 * static_cast<Eigen::Index>(i), columns.at(shared->sheet)) =
        marks_[i].whitening_1_mm * shared->modes_mm;
  }
}

void HeadFitter::dropFarMarks() {
  std::vector<Eigen::Vector2d> off(marks_.size(), Eigen::Vector2d::Zero());
  std::vector<double> x, y, distances;
  const auto here = landings(design_, tolerances_, scaled_, marks_);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    used_[i] = here[i].has_value();
    if (!used_[i]) continue;
    off[i] = marks_[i].measured_W_mm - *here[i];
    x.push_back(off[i].x());
    y.push_back(off[i].y());
  }
  if (x.empty()) throw HeadCalibrationError("no mark can be reached by this head");
  const Eigen::Vector2d middle(upperMedianOf(x), upperMedianOf(y));
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    if (used_[i]) distances.push_back((off[i] - middle).norm());
  }
  const double far_mm = kFarInMisses * upperMedianOf(distances);
  for (std::size_t i = 0; i < marks_.size(); ++i) used_[i] = used_[i] && (off[i] - middle).norm() <= far_mm;
  refuseTooMany();
}

void HeadFitter::fitRobustly() {
  const std::vector<WeighedMark> marks = usedMarks();
  const std::vector<WeighedMark> some = spreadOver(marks, kMarksToBegin);
  double last = INFINITY;
  bool converged = false;
  for (int pass = 0; pass < kMostRobustPasses; ++pass) {
    const std::vector<double> distances = distancesFrom(design_, tolerances_, scaled_, some);
    const double scale = std::max(1.0, upperMedianOf(distances) / std::sqrt(kMedianChiSquare2));
    if (scale >= 0.5 * last) break;
    last = scale;
    const ModelSolution solution =
        solveModel(design_, tolerances_, scaled_, some, 2.0 * scale, kRoughIterations);
    scaled_ = solution.scaled;
    converged = solution.converged;
  }
  const std::vector<double> distances = distancesFrom(design_, tolerances_, scaled_, marks);
  const double scale = std::max(1.0, upperMedianOf(distances) / std::sqrt(kMedianChiSquare2));
  std::size_t k = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (used_[i]) used_[i] = distances[k++] <= kFarInSigmas * scale;
  }
  refuseTooMany();
  if (converged) return;
  // However far this gets, solve() goes on from there and returns whether it settles.
  scaled_ =
      solveModel(design_, tolerances_, scaled_, spreadOver(usedMarks(), kMarksToBegin), 0.0, kMostIterations)
          .scaled;
}

std::vector<WeighedMark> HeadFitter::usedMarks() const {
  const double wide_mm = std::max(unmodelled_mm_, kStartShare * areaOfAims().sizes().maxCoeff());
  const Eigen::Matrix2d unmodelled = Eigen::Matrix2d::Identity() * wide_mm * wide_mm;
  std::vector<WeighedMark> marks;
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    if (!used_[i]) continue;
    marks.push_back(marks_[i]);
    marks.back().whitening_1_mm = whiteningOf(noise_mm2_[i] + unmodelled);
  }
  return marks;
}

void HeadFitter::reachRim() {
  if (options_.field_W_mm.isEmpty()) return;
  std::vector<Eigen::Vector2d> rim_W_mm;
  std::vector<WeighedMark> aims;
  for (const Eigen::Vector2d& share :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.5, 0.0), Eigen::Vector2d(1.0, 0.0),
        Eigen::Vector2d(0.0, 0.5), Eigen::Vector2d(1.0, 0.5), Eigen::Vector2d(0.0, 1.0),
        Eigen::Vector2d(0.5, 1.0), Eigen::Vector2d(1.0, 1.0)}) {
    const Eigen::AlignedBox2d& field = options_.field_W_mm;
    rim_W_mm.emplace_back(field.min() + share.cwiseProduct(field.sizes()));
    const Eigen::Vector2d aim_W_mm = axes_.matrix().transpose() * rim_W_mm.back();
    aims.emplace_back().angles_rad = axes_.matrix() * nominal_.angles_rad(aim_W_mm);
  }
  const auto here = landings(design_, tolerances_, scaled_, aims);
  for (std::size_t i = 0; i < aims.size(); ++i) {
    if (here[i]) reach_mm_.extend(axes_.matrix().transpose() * (2.0 * rim_W_mm[i] - *here[i]));
  }
}

Eigen::AlignedBox2d HeadFitter::areaOfAims() const {
  Eigen::AlignedBox2d area = options_.field_W_mm.merged(reach_mm_);
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (used_[i]) area.extend(observations_[i].aim_W_mm);
  }
  const Eigen::Vector2d margin = kAreaMargin * area.sizes();
  return {area.min() - margin, area.max() + margin};
}

}  // namespace kerfbench::calibrate
