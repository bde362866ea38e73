// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kerfbench::camera {

/// An edge of light on the pins (a strobe, or the laser's gate going on) and the first frame that shows it.
/// The light stays on until the end of that frame's exposure.
struct EdgeSighting {
  double edge_s{};        ///< Time on the clock of the pins.
  double dark_stamp_s{};  ///< The camera's stamp of the last frame before without the light.
  double lit_stamp_s{};   ///< Stamp of the first frame with it; later than the dark one.
  double row_delay_s{};   ///< Rolling shutter: how much later the row where it is seen begins; else 0.
  /// Brightness of that frame as a share of one that is lit throughout, if it was measured; in [0, 1].
  std::optional<double> lit_share;
};

/// Bounds by a frame's light or darkness of the begin of its exposure on the clock of the pins. A frame that
/// shows a light which was on from on_s to off_s at most began between on_s - exposure and off_s.
struct BeginSighting {
  double stamp_s{};  ///< The camera's, of the frame.
  double earliest_s{};
  double latest_s{};  ///< Latest begin; not before earliest_s.
};

/// Prior knowledge. The bounds are bounds, not standard deviations: the result of the fit rests on them.
struct CameraClockOptions {
  double exposure_s{};       ///< Exposure of every frame; > 0.
  double stamp_jitter_s{};   ///< A stamp is off by at most this; >= 0.
  double edge_error_s{};     ///< The pins' stamps likewise; >= 0.
  double unseen_share{0.1};  ///< Light for less than this share of an exposure may go unseen; [0, 1].
  double share_error{0.05};  ///< Error of lit_share; [0, 1].
  /// Light comes on and goes off at once and is as strong all along, so that a dark frame had none but for
  /// unseen_share. fitLightClock() alone asks.
  bool is_light_hard{};
  double max_drift{500e-6};        ///< Drift of one clock against the other; [0, 0.1]. Crystals: 100e-6 each.
  double max_uncertainty_s{1e-3};  ///< More, anywhere between first and last sighting, is no answer; > 0.
};

/// Begin of exposure on the clock of the pins = stamp + offset + drift * (stamp - reference). Holds for the
/// format, frame rate and exposure that it was measured with, and between the sightings that it was measured
/// from; beyond them the uncertainty grows with the drift's, which is taken to be constant.
class CameraClock {
 public:
  /// One of the lines that the sightings allow.
  struct Line {
    double offset_s{};
    double drift{};
  };
  /// All of a convex set of lines is spanned by its corners. @throws std::invalid_argument if there are none.
  CameraClock(double reference_stamp_s, std::vector<Line> corners);

  [[nodiscard]] double beginOf_s(double stamp_s) const;
  /// Half of the range that the sightings leave: a bound.
  [[nodiscard]] double uncertaintyAt_s(double stamp_s) const;
  [[nodiscard]] double referenceStamp_s() const { return reference_stamp_s_; }
  [[nodiscard]] const Line& line() const { return middle_; }
  [[nodiscard]] double driftUncertainty() const;

 private:
  double reference_stamp_s_;
  std::vector<Line> corners_;
  Line middle_;
};

struct CameraClockFit {
  std::optional<CameraClock> clock;
  std::string why_not;  ///< Reason in words, where there is no clock.
  /// Sightings that contradict the others: leaving out any one of these makes the rest agree. Empty where all
  /// agree.
  std::vector<std::size_t> suspects;
};

/// Relates a camera's clock to that of the pins.
///
/// Each sighting bounds when its frame began: two parallel constraints on (offset, drift). What all of them
/// allow is a convex polygon, found by clipping, and no assumption on how errors are distributed is made.
/// That matters: edges locked to the frame rate all fall on the same place of a frame, and thousands of them
/// tell no more than one; a least-squares fit would not notice.
///
/// One sighting may be wrong, and need not show: the answer spans the polygons of all sightings but one, for
/// each one that may be left out. If the bounds hold for all sightings but one, the truth is inside. An
/// answer of no clock comes with the reason. @throws std::invalid_argument that names every option out of
/// range.
CameraClockFit fitCameraClock(std::span<const EdgeSighting> sightings, const CameraClockOptions& options);
/// Fits the clock to the begins of frames. Only a light's first and last frames contribute much; others may
/// be left out.
CameraClockFit fitCameraClockToBegins(std::span<const BeginSighting> sightings,
                                      const CameraClockOptions& options);

}  // namespace kerfbench::camera
