// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hil/camera/v4l2/camera_clock.h"

namespace kerfbench::camera {

/// Light in one frame.
struct FrameLight {
  double stamp_s{};  ///< The camera's.
  double light{};    ///< Light of the whole spot above its surroundings, in any unit; 0: dark.

  [[nodiscard]] bool isLit() const { return light > 0.0; }
};

/// Light that the pins ask for, over time: a level that is on or off, so fast (PWM) that its mean counts.
class LightProfile {
 public:
  struct Step {
    double time_s{};
    bool is_on{};
  };
  /// Takes the steps in order of time; the light is off before the first.
  explicit LightProfile(std::span<const Step> steps);
  /// Share of the time for which the light was on; `to_s` > `from_s`.
  [[nodiscard]] double meanOver(double from_s, double to_s) const;
  /// Time on until then.
  [[nodiscard]] double onUntil_s(double time_s) const;

 private:
  struct Knot {
    double time_s{};
    double on_s{};  ///< Time for which the light was on until then.
    bool is_on{};   ///< After.
  };
  std::vector<Knot> knots_;
};

/// A clock that is known roughly, sharpened: light in the lit frames is taken to be in proportion to what the
/// pins ask for during their exposure and, of a sluggish light, around it. Offset and drift are those with
/// which that leaves least: all that the rough clock allows are tried; where they are too many, or exposures
/// are finer than the jitter of stamps, by the light of a longer time around each frame, and no sharper than
/// that. Its ± covers 99.7 %, by leaving out a tenth of the frames after the other, and options.edge_error_s
/// for what is alike in all of them (the tube's delay). Nothing where too few frames are lit to tell, where
/// the light is not what the pins ask for, where another place fits nearly as well, where it is no sharper
/// than before, or leaves the bounds known before.
std::optional<CameraClock> sharpened(const CameraClock& rough, std::span<const FrameLight> frames,
                                     const LightProfile& profile, const CameraClockOptions& options);

}  // namespace kerfbench::camera
