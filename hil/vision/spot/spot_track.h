// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/camera/frame_source.h"
#include "hil/vision/image/camera_calibration.h"
#include "twin/base/image.h"
#include "twin/base/print_layout.h"
#include "twin/base/read_out.h"

namespace kerfbench::vision {

/// Pose of one unit of the web, by its printed marks: p_W = R(angle) p_S + t, rigid. S is the unit's own
/// frame S_k, the dieline's coordinates: the pose of unit k + 1 lies one pitch upstream (-x) of that of unit
/// k.
struct SheetPose {
  int unit{};  ///< Unit whose marks were seen.
  Eigen::Vector2d p_WS_mm{Eigen::Vector2d::Zero()};
  double angle_rad{};
  double residual_mm{};  ///< RMS distance of the marks from their places; NaN with one mark.
  int marks{};           ///< Number of marks; one alone keeps the angle of the frames before.
  int expected{};        ///< Marks that lie well within the picture and not under the spot.
  int moved{};           ///< Marks that were seen elsewhere than the others make expect; not used.
  /// Covariance of p_WS x, p_WS y and angle by the noise of this frame: mm², mm rad, rad²; without map_u_mm.
  /// With one mark the angle has the uncertainty of its last measurement, and the same error in all frames
  /// since.
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};
  /// Which marks of the print were seen, in their order there; empty: not told.
  std::vector<std::size_t> seen{};
};

/// Faults that make a frame unfit to measure in.
struct FrameFaults {
  bool dark{};       ///< Hardly any light on the board.
  bool saturated{};  ///< A large part of the picture is as bright as it can be.
  bool blurred{};    ///< The spot is wider than SpotTrackOptions::widest_spot_mm.
  bool lifeless{};   ///< Picture without any noise, so not of a sensor.
  [[nodiscard]] bool any() const { return dark || saturated || blurred || lifeless; }
};

/// Box of the work plane W, mm, in which the beam's spot should be between two times on the clock of the
/// pins, s, late mirrors and slides included; nullopt: not known. It only says where to look: a spot that is
/// elsewhere is not seen.
using BeamAim = std::function<std::optional<Eigen::AlignedBox2d>(double from_s, double to_s)>;

/// Measurement of one frame of the spot camera.
struct FrameMeasurement {
  std::uint64_t sequence{};
  double mid_s{};                            ///< Middle of the exposure.
  std::optional<Eigen::Vector2d> spot_W_mm;  ///< Centre of the glowing spot; absent when the laser was dark.
  /// Estimated standard uncertainty per axis, mm: noise and the grain of the board, but neither what the
  /// board multiplies the glow by nor map_u_mm.
  double spot_sigma_mm{};
  std::vector<SheetPose> sheet;  ///< One pose for each unit with marks in view.
  FrameFaults faults{};
  double exposure_s{};  ///< Length of the exposure; 0: not told.
};

struct SpotTrackOptions {
  int threads{1};  ///< The result is the same at any number.
  /// Speed of the belt, to tell the units apart between frames; from the scenario.
  double nominal_speed_mm_s{};
  /// Standard deviation of the light across its path beyond which the picture is blurred, mm.
  double widest_spot_mm{0.3};
  /// The part of the picture that all frames show; absent: all of it.
  std::optional<PixelWindow> window{};
  /// Where the beam should be. With it, frames are asked for by windows around spot and marks, once the marks
  /// were found in a whole picture; the whole ones before are no part of the track. Without it, and from a
  /// source that has no windows, all are whole.
  BeamAim aim{};
  /// What the camera can read out within a period, by its data sheet: of more marks than that, some are read
  /// in one frame and others in the next. A camera that has no time for any beside the spot, or is late by
  /// itself, is told among the problems.
  ReadOut read_out{};
  double frame_period_s{};  ///< 0: not told.
};

struct SpotTrack {
  std::vector<FrameMeasurement> frames;
  std::uint64_t frames_lost{};  ///< Gaps in the sequence: INVALID when any is > 0.
  /// Reasons not to judge by the frames, in sentences: unfit frames, marks missing or moved in many of them,
  /// a camera that was not ready in time for its windows. INVALID when there is any. Lost frames are in
  /// frames_lost alone.
  std::vector<std::string> problems{};
};

/// Measures all frames: spot by a sub-pixel estimator, anywhere in a whole picture or in its window; sheet
/// pose from the printed marks. Unit 0 is the first that enters the view; later ones follow one pitch
/// upstream.
SpotTrack trackSpot(camera::FrameSource& source, const CameraCalibration& calibration,
                    const PrintLayout& print, const SpotTrackOptions& options);

}  // namespace kerfbench::vision
