// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/diagnose/evidence.h"
#include "hil/evidence/counted_steps.h"
#include "hil/inspect/evidence/pin_evidence.h"
#include "hil/judge/beam_aim.h"
#include "hil/vision/spot/spot_track.h"
#include "twin/base/print_layout.h"

namespace kerfbench::judge {

/// Where the pulses of a whole run led the beam over time, W: the mean over kSmooth_s of the places of whole
/// steps, less the tracking delay of the axes.
class AskedPath {
 public:
  using PlaceOfSteps = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& steps)>;
  AskedPath(const SharedSteps& steps, const PlaceOfSteps& place, double end_s, double delay_s);

  /// Unknown beyond the recording, and where the beam has no place.
  [[nodiscard]] diagnose::HeadState at(double time_s) const;
  [[nodiscard]] double end_s() const { return end_s_; }

  static constexpr double kRaster_s = 1e-4;
  static constexpr double kSmooth_s = 1e-3;

 private:
  [[nodiscard]] Eigen::Vector2d placeAt(double time_s) const;

  void follow();

  std::vector<Eigen::Vector2d> p_mm_;
  std::vector<Eigen::Vector2d> flank_, forward_mm_;  ///< As in diagnose::HeadState.
  double end_s_;
  double delay_s_;
};

/// Where each unit of the web lies over time: by its printed marks, between the frames by the belt's encoder.
class SheetPath {
 public:
  SheetPath(const vision::SpotTrack& track, const std::vector<inspect::BeltEdge>& belt, double start_x_mm,
            const PrintLayout& print);

  struct Pose {
    Eigen::Vector2d p_mm{0, 0};
    double angle_rad{};
  };
  [[nodiscard]] Pose at(int unit, double time_s) const;
  [[nodiscard]] double speedAt_mm_s(double time_s) const;
  /// A place of W in the frame S of a unit.
  [[nodiscard]] Eigen::Vector2d inSheet(int unit, double time_s, const Eigen::Vector2d& p_W_mm) const;
  /// Travel of the sheet over that of the encoder, as it counts.
  [[nodiscard]] std::optional<diagnose::BeltReading> scale() const;

 private:
  struct Seen {
    double time_s{}, belt_mm{};
    Eigen::Vector2d p_mm{0, 0};
    double angle_rad{}, weight{};
  };
  [[nodiscard]] double belt_mm(double time_s) const;

  std::vector<std::vector<Seen>> units_;
  std::vector<inspect::BeltEdge> belt_;
  double start_x_mm_, pitch_mm_;
};

}  // namespace kerfbench::judge
