// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/space/space_readings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/edges/edges.h"

namespace kerfbench::inspect {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Kerf radii from a fold up to which a joint may lead the edge away, and from a free end up to which its
/// rounding does; with a little more for the beam's skirt.
constexpr double kFoldRadii = 2.0;
constexpr double kEndRadii = 1.0;
constexpr double kSkirt_mm = 0.1;
/// As deviations.cpp has them for widths, where their reasons stand.
constexpr double kFlanks = 1.4;
constexpr double kOwnBlurShare = 0.032;

Vector3d onFace(const Vector2d& p_F_mm) { return {p_F_mm.x(), p_F_mm.y(), 0.0}; }

/// A line of the contour with the directions that distances from it are told by.
struct LineInSpace {
  std::size_t index;
  const SpaceLine* line;
  Vector3d from_W_mm, along_W, beside_W, above_W;
  double side;
};

LineInSpace inSpace(const SpaceJob& job, std::size_t index, const std::vector<ContourPoint>& contour) {
  const SpaceLine& line = job.lines[index];
  const ContourPoint& from = contour[line.point];
  const Vector3d along = (contour[line.point + 1].p_W_mm - from.p_W_mm).normalized();
  const Vector3d above = (from.axis_W - from.axis_W.dot(along) * along).normalized();
  return {index, &line, from.p_W_mm, along, job.side * above.cross(along), above, job.side};
}

double clearOf(LineEndKind kind, double radius_mm) {
  if (kind == LineEndKind::kFold) return kFoldRadii * radius_mm + kSkirt_mm;
  if (kind == LineEndKind::kFree) return kEndRadii * radius_mm + kSkirt_mm;
  return 0.0;  // Calipers near a corner say so themselves.
}

EdgeZone zoneOf(const SpaceLine& line, double way_mm, bool near_joint, double radius_mm) {
  const double left_mm = line.length_mm - way_mm;
  const bool near_begin = way_mm < clearOf(line.begin, radius_mm);
  const bool near_end = left_mm < clearOf(line.end, radius_mm);
  if ((near_begin && line.begin == LineEndKind::kFree) || (near_end && line.end == LineEndKind::kFree))
    return EdgeZone::kEnd;
  return near_begin || near_end || near_joint ? EdgeZone::kJoint : EdgeZone::kAlong;
}

/// Ways in which a place in the face may be misread, but for noise: a shift in F for a standard deviation of
/// each.
class FaceErrors {
 public:
  FaceErrors(const vision::KerfScan& scan, const SpaceInstruments& instruments) : scan_(scan) {
    if (!scan.units.empty()) {
      const vision::UnitPose& unit = scan.units.front();
      const Eigen::Matrix3d tiny = 1e-18 * Eigen::Matrix3d::Identity();
      root_ = (unit.covariance + tiny).llt().matrixL();
      turned_ = Eigen::Rotation2Dd(-unit.angle_rad).toRotationMatrix();
      centre_F_mm_ = unit.marks_centre_S_mm;
    }
    map_u_mm_ = instruments.kerf_map_u_mm;
  }

  /// Adds the shifts of a place, and their sources; `width` is the shift by the kerf's width, `steady` that
  /// by what the flanks of this line have in common.
  void add(const Vector2d& p_F_mm, const Vector2d& width, const Vector2d& steady,
           std::vector<Vector2d>& shifts, std::vector<EdgeSource>& sources) const {
    const auto put = [&](const Vector2d& shift, EdgeSource source) {
      shifts.push_back(shift);
      sources.push_back(source);
    };
    const Vector2d across(-p_F_mm.y(), p_F_mm.x());
    for (Eigen::Index k = 0; k < 3; ++k)
      put(turned_ * root_.col(k).head<2>() + root_(2, k) * across, kByKerfPose);
    put(width, kByKerfWidth);
    put(scan_.scale_sigma * (p_F_mm - centre_F_mm_), kByKerfScale);
    put(Vector2d(map_u_mm_, 0.0), kByKerfScale);
    put(Vector2d(0.0, map_u_mm_), kByKerfScale);
    put(steady, kBySteady);
  }

 private:
  const vision::KerfScan& scan_;
  Eigen::Matrix3d root_{Eigen::Matrix3d::Zero()};
  Eigen::Matrix2d turned_{Eigen::Matrix2d::Identity()};
  Vector2d centre_F_mm_{Vector2d::Zero()};
  double map_u_mm_{};
};

/// One face, to be read.
struct FaceReader {
  const SpaceJob& job;
  const FaceEvidence& evidence;
  FaceErrors errors;

  /// Reads a kerf that is looked at from the way `from_mm` of its line on; `seen` is the same with the widths
  /// by the light.
  void read(const vision::EntityKerf& kerf, const vision::EntityKerf& seen, double from_mm,
            const LineInSpace& line, std::vector<EdgeReading>& readings) const {
    for (std::size_t i = 0; i < kerf.calipers.size(); ++i) {
      const vision::Caliper& caliper = kerf.calipers[i];
      EdgeReading reading;
      reading.line = line.index;
      reading.way_mm = from_mm + caliper.station_mm;
      if (reading.way_mm < 0.0 || reading.way_mm > line.line->length_mm) continue;
      reading.zone = zoneOf(*line.line, reading.way_mm, caliper.near_joint, job.kerf_radius_mm);
      reading.strict = reading.way_mm >= line.line->kerf_from_mm && reading.way_mm <= line.line->kerf_to_mm;
      reading.open = caliper.brightness >= checks::kOpenBrightness;
      reading.found = evidence.pose && caliper.found && std::isfinite(caliper.offset_mm) &&
                      std::isfinite(caliper.width_mm) && caliper.width_mm > 0.0;
      reading.beside_mm = reading.above_mm = std::numeric_limits<double>::quiet_NaN();
      if (reading.found) {
        place(kerf, caliper, line, reading);
        boundByLight(seen, i, reading);
      }
      readings.push_back(std::move(reading));
    }
  }

  static void boundByLight(const vision::EntityKerf& seen, std::size_t i, EdgeReading& reading) {
    const vision::Caliper& caliper = seen.calipers[i];
    const double wider_mm = 0.5 * caliper.width_mm - reading.half_mm;
    double square_mm2 =
        caliper.sigma_mm * caliper.sigma_mm + 0.25 * (caliper.width_sigma_mm * caliper.width_sigma_mm +
                                                      seen.widening_sigma_mm * seen.widening_sigma_mm);
    for (std::size_t k = 0; k < reading.sources.size(); ++k) {
      const double mode_mm = reading.beside_modes[static_cast<Eigen::Index>(k)];
      if (reading.sources[k] != kByKerfWidth) square_mm2 += mode_mm * mode_mm;
    }
    reading.most_lost_mm = wider_mm - reading.beside_mm + 2.0 * std::sqrt(square_mm2);
  }

  void place(const vision::EntityKerf& kerf, const vision::Caliper& caliper, const LineInSpace& line,
             EdgeReading& reading) const {
    // Offsets are positive to the left of the line, `beside` is to the kerf's side of it.
    const double middle_mm = line.side * caliper.offset_mm;
    const double half_mm = 0.5 * caliper.width_mm;
    reading.half_mm = half_mm;
    const Vector2d& beside_F = line.line->beside_F;
    const Vector2d edge_F_mm = caliper.p_S_mm + (middle_mm - half_mm) * beside_F;
    const double steady_mm = std::min(kFlanks * caliper.steady_sigma_mm, caliper.sigma_mm);
    const double own_mm = std::sqrt(std::max(
        0.0, caliper.sigma_mm * caliper.sigma_mm - caliper.steady_sigma_mm * caliper.steady_sigma_mm));
    reading.noise_mm = std::hypot(own_mm, 0.5 * caliper.width_sigma_mm);
    const double width_mm = 0.5 * std::hypot(kerf.widening_sigma_mm, kOwnBlurShare * kerf.widening_mm);
    std::vector<Vector2d> shifts_F;
    errors.add(edge_F_mm, width_mm * beside_F, steady_mm * beside_F, shifts_F, reading.sources);
    const vision::FacePose& pose = *evidence.pose;
    reading.edge_W_mm = pose.X_WF * onFace(edge_F_mm);
    std::vector<Vector3d> shifts_W;
    for (const Vector2d& shift : shifts_F) shifts_W.emplace_back(pose.X_WF.linear() * onFace(shift));
    for (const vision::SmallMotion& mode : pose.modes) {
      shifts_W.push_back(pose.shift(mode, reading.edge_W_mm));
      reading.sources.push_back(kBySurvey);
    }
    const Vector3d off = reading.edge_W_mm - line.from_W_mm;
    reading.beside_mm = off.dot(line.beside_W);
    reading.above_mm = off.dot(line.above_W);
    const auto modes = static_cast<Eigen::Index>(shifts_W.size());
    reading.beside_modes.resize(modes);
    reading.above_modes.resize(modes);
    for (Eigen::Index k = 0; k < modes; ++k) {
      reading.beside_modes[k] = shifts_W[static_cast<std::size_t>(k)].dot(line.beside_W);
      reading.above_modes[k] = shifts_W[static_cast<std::size_t>(k)].dot(line.above_W);
    }
  }
};

/// The scan with the widths of its kerfs as the board is severed.
vision::KerfScan severedOf(const vision::KerfScan& scan, const SpaceJob& job, const FaceDrawing& drawing,
                           const SpaceInstruments& instruments) {
  checks::EdgeSides sides;
  sides.side.assign(drawing.lines.size(), job.side > 0.0 ? 1 : -1);
  return checks::severedScan(scan, sides, instruments.beam_radius_mm, instruments.board_transmission);
}

}  // namespace

double EdgeReading::distance_mm() const { return std::hypot(beside_mm, above_mm); }

std::vector<EdgeReading> readEdges(const SpaceJob& job, const std::vector<FaceEvidence>& faces,
                                   const std::vector<ContourPoint>& contour,
                                   const SpaceInstruments& instruments) {
  std::vector<EdgeReading> readings;
  for (std::size_t face = 0; face < job.faces.size(); ++face) {
    const FacePlan plan = planFace(job, face);
    const FaceErrors errors(faces[face].scan, instruments);
    const FaceReader reader{job, faces[face], errors};
    for (const auto& [scan, drawing] :
         {std::pair(&faces[face].scan, &plan.kerfs), std::pair(&faces[face].beyond, &plan.beyond)}) {
      vision::KerfScan severed = severedOf(*scan, job, *drawing, instruments);
      for (std::size_t i = 0; i < severed.entities.size(); ++i) {
        vision::EntityKerf& kerf = severed.entities[i];
        const auto k = static_cast<std::size_t>(kerf.entity);
        // How well the picture's blur is known the whole kerfs tell.
        if (scan == &faces[face].beyond && !faces[face].scan.entities.empty()) {
          const vision::EntityKerf& whole = faces[face].scan.entities.front();
          kerf.widening_mm = whole.widening_mm;
          kerf.widening_sigma_mm = std::hypot(kerf.widening_sigma_mm, whole.widening_sigma_mm);
        }
        reader.read(kerf, scan->entities[i], drawing->from_mm.at(k),
                    inSpace(job, drawing->lines.at(k), contour), readings);
      }
    }
  }
  std::ranges::stable_sort(readings, [](const EdgeReading& a, const EdgeReading& b) {
    return a.line != b.line ? a.line < b.line : a.way_mm < b.way_mm;
  });
  return readings;
}

}  // namespace kerfbench::inspect
