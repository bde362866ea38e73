// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/error_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "hil/dieline/geometry.h"
#include "twin/base/statistics.h"
#include "twin/base/symmetric_eigen.h"

namespace kerfbench::inspect {
namespace {

// Found with `kerfbench gauge`: with it the intervals hold the truth of artefacts as often as they say.
constexpr double kEstimatorPx = 0.005;
constexpr double kLeastNoise_mm = 1e-5;
constexpr double kMostCorrelated = 0.95;
constexpr std::size_t kFewestDifferences = 30;
constexpr double kClipped = 0.9850;  // Variance left by clipping a normal value at 3 sigma.

/// Square root of a covariance, column by column; small negative eigenvalues are rounding.
Eigen::Matrix3d rootOf(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return Eigen::Matrix3d::Constant(std::nan(""));
  const SymmetricEigen<3> solver(covariance);
  return solver.vectors * solver.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// The two columns of each tile that kerfs were read in, tiles of all units counted together. None where the
/// table's error does not matter.
std::map<std::pair<int, int>, Eigen::Index> tileColumns(const vision::KerfScan& scan) {
  std::map<std::pair<int, int>, Eigen::Index> columns;
  if (!(scan.table_sigma_mm > 0.0)) return columns;
  for (const vision::EntityKerf& kerf : scan.entities) {
    for (const vision::Caliper& c : kerf.calipers) {
      if (c.found) columns.try_emplace({kerf.unit, c.tile}, 2 * static_cast<Eigen::Index>(columns.size()));
    }
  }
  return columns;
}

/// What the error of a unit's pose, the table's and the modes of the camera make of one offset.
class SharedErrors {
 public:
  SharedErrors(const Evidence& evidence, const ModeField& field)
      : field_(field),
        camera_(evidence.kerf_calibration.value_or(vision::CameraCalibration{})),
        table_sigma_mm_(evidence.kerf.table_sigma_mm),
        scale_sigma_(evidence.kerf.scale_sigma),
        tile_columns_(tileColumns(evidence.kerf)) {
    for (const vision::UnitPose& pose : evidence.kerf.units)
      places_.try_emplace(pose.unit, Place{&pose, rootOf(pose.covariance)});
  }

  [[nodiscard]] Eigen::Index tiles() const { return 2 * static_cast<Eigen::Index>(tile_columns_.size()); }
  /// Columns of what all units have in common but for the tiles.
  [[nodiscard]] Eigen::Index camera() const {
    return field_.modes() + ReadingLine::kScale + ReadingLine::kSight;
  }
  /// Fills tiles and shared of a line whose readings are known.
  void addTo(const vision::EntityKerf& kerf, const dieline::Curve& curve, ReadingLine& line) const {
    for (const std::size_t caliper : line.caliper) {
      const auto tile = tile_columns_.find({kerf.unit, kerf.calipers[caliper].tile});
      if (tile == tile_columns_.end() || std::ranges::find(line.tiles, tile->second) != line.tiles.end())
        continue;
      line.tiles.push_back(tile->second);
      line.tiles.push_back(tile->second + 1);
    }
    line.shared.resize(static_cast<Eigen::Index>(line.size()),
                       ReadingLine::kOwn + line.tileColumns() + camera());
    const auto known = places_.find(kerf.unit);
    const Place* const place = known == places_.end() ? nullptr : &known->second;
    for (std::size_t i = 0; i < line.size(); ++i) {
      line.shared.row(static_cast<Eigen::Index>(i)) =
          of({kerf, curve, place}, kerf.calipers[line.caliper[i]], line);
    }
  }

 private:
  struct Place {
    const vision::UnitPose* pose;
    Eigen::Matrix3d root;
  };
  /// A line on its sheet; `place` is null where nobody knows how that lies.
  struct Laid {
    const vision::EntityKerf& kerf;
    const dieline::Curve& curve;
    const Place* place;
  };
  [[nodiscard]] Eigen::RowVectorXd of(const Laid& laid, const vision::Caliper& c,
                                      const ReadingLine& line) const {
    const auto& [kerf, curve, place] = laid;
    const Eigen::Index behind_tiles = ReadingLine::kOwn + line.tileColumns();
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(behind_tiles + camera());
    row[ReadingLine::directionOf(dieline::tangentAt(curve, c.u))] = c.steady_sigma_mm;
    if (place == nullptr) return row;
    const Eigen::Matrix2d R_TS = Eigen::Rotation2Dd(place->pose->angle_rad).toRotationMatrix();
    const Eigen::Vector2d tangent = R_TS * dieline::tangentAt(curve, c.u);
    const Eigen::Vector2d normal(-tangent.y(), tangent.x());
    const Eigen::Vector2d arm = R_TS * c.p_S_mm;
    // A turn by da moves the point at `arm` by da times `arm` turned by a right angle.
    const Eigen::RowVector3d by_pose(normal.x(), normal.y(), normal.dot(Eigen::Vector2d(-arm.y(), arm.x())));
    row.segment<ReadingLine::kPose>(ReadingLine::kLine) = by_pose * place->root;
    const auto tile = tile_columns_.find({kerf.unit, c.tile});
    if (tile != tile_columns_.end()) {
      const auto own = std::ranges::find(line.tiles, tile->second) - line.tiles.begin();
      row.segment<2>(ReadingLine::kOwn + own) = table_sigma_mm_ * normal.transpose();
    }
    for (Eigen::Index k = 0; k < field_.modes(); ++k)
      row[behind_tiles + k] = normal.dot(field_.at(k, c.p_V_mm));
    row[behind_tiles + field_.modes()] =
        scale_sigma_ * normal.dot(R_TS * (c.p_S_mm - place->pose->marks_centre_S_mm));
    const double unsquare_mm = 0.5 * kerf.deepest_mm() * camera_.square_within_rad;
    row.tail<ReadingLine::kSight>() << kerf.depth_sigma_mm * normal.dot(camera_.sightSlope(c.p_V_mm)),
        unsquare_mm * normal.x(), unsquare_mm * normal.y();
    return row;
  }

  const ModeField& field_;
  vision::CameraCalibration camera_;
  double table_sigma_mm_;
  double scale_sigma_;
  std::map<std::pair<int, int>, Eigen::Index> tile_columns_;
  std::map<int, Place> places_;  ///< Places by unit.
};

/// What of a caliper's uncertainty is its own. Never nothing: rounding is left.
double noiseOf(const vision::Caliper& c) {
  const double noise = c.sigma_mm * c.sigma_mm - c.steady_sigma_mm * c.steady_sigma_mm;
  return std::sqrt(std::max(noise, kLeastNoise_mm * kLeastNoise_mm));
}

double pitchOf(const vision::EntityKerf& kerf) {
  return kerf.calipers.size() < 2 ? 1.0 : kerf.calipers[1].station_mm - kerf.calipers[0].station_mm;
}

/// Makes the lines of a scan, one at a time.
class LineMaker {
 public:
  explicit LineMaker(const Evidence& evidence)
      : evidence_(evidence),
        field_(evidence.kerf_calibration.value_or(vision::CameraCalibration{})),
        shared_(evidence, field_),
        correlation_mm_(correlationLength()) {}
  LineMaker(const LineMaker&) = delete;
  LineMaker& operator=(const LineMaker&) = delete;

  [[nodiscard]] const SharedErrors& shared() const { return shared_; }
  [[nodiscard]] double correlation_mm() const { return correlation_mm_; }
  [[nodiscard]] ReadingLine line(std::size_t number, ErrorModel::Part part) const {
    const vision::EntityKerf& kerf = evidence_.kerf.entities[number];
    ReadingLine line = readings(number);
    line.q = correlation_mm_ > 0.0 ? std::exp(-pitchOf(kerf) / correlation_mm_) : 0.0;
    line.q = std::min(line.q, kMostCorrelated);
    if (part == ErrorModel::Part::kAll)
      shared_.addTo(kerf, evidence_.dieline->entities[static_cast<std::size_t>(kerf.entity)].curve, line);
    return line;
  }

 private:
  [[nodiscard]] ReadingLine readings(std::size_t number) const {
    const vision::EntityKerf& kerf = evidence_.kerf.entities[number];
    ReadingLine line;
    line.kerf = number;
    line.unit = kerf.unit;
    for (std::size_t i = 0; i < kerf.calipers.size(); ++i) {
      const vision::Caliper& c = kerf.calipers[i];
      if (!judgesOffset(c)) continue;
      if (line.caliper.empty() || line.caliper.back() + 1 != i) line.segment.push_back(line.size());
      line.caliper.push_back(i);
      if (shared_.tiles() > 0) line.tile.push_back(c.tile);
      line.reading_mm.push_back(c.offset_mm);
      line.sigma_mm.push_back(noiseOf(c));
    }
    line.segment.push_back(line.size());
    return line;
  }

  /// Correlation length of the noise, from all lines together: stations are about equally far apart on all.
  [[nodiscard]] double correlationLength() const {
    NeighbourCorrelation correlation;
    double pitches_mm = 0.0;
    double weight = 0.0;
    for (std::size_t k = 0; k < evidence_.kerf.entities.size(); ++k) {
      const ReadingLine line = readings(k);
      for (std::size_t s = 0; s + 1 < line.segment.size(); ++s) {
        std::vector<double> one;
        for (std::size_t i = line.segment[s]; i < line.segment[s + 1]; ++i)
          one.push_back(line.reading_mm[i] / line.sigma_mm[i]);
        weight += static_cast<double>(one.size());
        pitches_mm += static_cast<double>(one.size()) * pitchOf(evidence_.kerf.entities[k]);
        correlation.add(one);
      }
    }
    const double q = correlation.value();
    return q > 0.0 ? -pitches_mm / weight / std::log(q) : 0.0;
  }

  const Evidence& evidence_;
  ModeField field_;
  SharedErrors shared_;
  double correlation_mm_;
};

}  // namespace

bool judgesOffset(const vision::Caliper& c) { return c.found && !c.near_joint && std::isfinite(c.offset_mm); }

Eigen::Index ReadingLine::directionOf(const Eigen::Vector2d& tangent) {
  const double eighths = std::atan2(tangent.y(), tangent.x()) / (std::numbers::pi / 4.0);
  return (static_cast<Eigen::Index>(std::lround(eighths)) + kLine) % kLine;
}

void NeighbourCorrelation::add(std::span<const double> series) {
  for (std::size_t i = 0; i + 3 < series.size(); ++i) {
    const double d = series[i] - 3.0 * series[i + 1] + 3.0 * series[i + 2] - series[i + 3];
    if (std::isfinite(d)) squares_.push_back(d * d / 20.0);
  }
}

double NeighbourCorrelation::value() {
  if (squares_.size() < kFewestDifferences) return 0.0;
  const double limit = 9.0 * upperMedianIn(squares_) / kMedianSquare;
  double sum = 0.0;
  for (const double s : squares_) sum += std::min(s, limit) / kClipped;
  const double share = sum / static_cast<double>(squares_.size());
  // Variance of the difference for correlations q, q², q³ of readings 1, 2, 3 apart; it falls with q.
  const auto expected = [](double q) { return (20.0 - 30.0 * q + 12.0 * q * q - 2.0 * q * q * q) / 20.0; };
  double low = 0.0;
  double high = kMostCorrelated;
  for (int i = 0; i < 50; ++i) {
    const double q = 0.5 * (low + high);
    (expected(q) > share ? low : high) = q;
  }
  return low;
}

double neighbourCorrelation(const std::vector<std::vector<double>>& series) {
  NeighbourCorrelation correlation;
  for (const std::vector<double>& one : series) correlation.add(one);
  return correlation.value();
}

ModeField::ModeField(const vision::CameraCalibration& calibration) : area_mm_(calibration.area_mm) {
  for (std::size_t k = 0; k < calibration.error_modes.size(); ++k) {
    std::vector<Eigen::Vector2d>& shifts = shift_mm_.emplace_back();
    for (int row = 0; row < kNodes; ++row) {
      for (int column = 0; column < kNodes; ++column) {
        const Eigen::Vector2d share(column / (kNodes - 1.0), row / (kNodes - 1.0));
        shifts.push_back(calibration.mapError(k, area_mm_.min() + area_mm_.sizes().cwiseProduct(share)));
      }
    }
  }
}

Eigen::Vector2d ModeField::at(Eigen::Index mode, const Eigen::Vector2d& p_mm) const {
  const Eigen::Array2d nodes = ((p_mm - area_mm_.min()).array() / area_mm_.sizes().array() * (kNodes - 1.0))
                                   .max(0.0)
                                   .min(kNodes - 1.0);
  const Eigen::Array2i cell = nodes.cast<int>().min(kNodes - 2);
  const Eigen::Array2d t = nodes - cell.cast<double>();
  const auto& shifts = shift_mm_[static_cast<std::size_t>(mode)];
  const auto node = [&](int dx, int dy) -> const Eigen::Vector2d& {
    return shifts[static_cast<std::size_t>((cell.y() + dy) * kNodes + cell.x() + dx)];
  };
  return (1.0 - t.y()) * ((1.0 - t.x()) * node(0, 0) + t.x() * node(1, 0)) +
         t.y() * ((1.0 - t.x()) * node(0, 1) + t.x() * node(1, 1));
}

ErrorModel errorModelOf(const Evidence& evidence) {
  ErrorModel model;
  if (evidence.kerf_calibration) model.estimator_mm = kEstimatorPx * evidence.kerf_calibration->pitchMm();
  const auto maker = std::make_shared<const LineMaker>(evidence);
  model.tiles = maker->shared().tiles();
  model.modes = maker->shared().tiles() + maker->shared().camera();
  model.correlation_mm = maker->correlation_mm();
  model.made = evidence.kerf.entities.size();
  model.make = [maker](std::size_t line, ErrorModel::Part part) { return maker->line(line, part); };
  return model;
}

}  // namespace kerfbench::inspect
