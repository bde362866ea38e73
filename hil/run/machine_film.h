// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "hil/base/spilled_vector.h"
#include "twin/description/description.h"
#include "twin/description/machine_pose.h"
#include "twin/scene/scene.h"

namespace kerfbench::twin {
class Twin;
}

namespace kerfbench::run {

/// Where machine and beam were, quantum by quantum: what pictures of a run need. Nothing that judges may use
/// it. 120 bytes a quantum, in a temporary file when they are many.
class MachineFilm {
 public:
  /// `full_power_w`: the laser counts as on from a hundredth of it.
  explicit MachineFilm(double full_power_w) : lit_w_(0.01 * full_power_w) {}

  /// The state now; a time that is there already is not added again.
  void add(const twin::Twin& twin);

  [[nodiscard]] bool empty() const { return frames_.empty(); }
  [[nodiscard]] double end_s() const { return frames_.empty() ? 0.0 : frames_.back().time_s; }
  /// The middle of the longest path that was cut without a break, by its length on the sheet; the end if
  /// nothing was cut.
  [[nodiscard]] double middleOfLongestCut_s() const;

  /// The machine as it was at the last quantum's end up to then, the beam as in that quantum, and all that
  /// was burnt by then. @throws std::logic_error if empty.
  [[nodiscard]] twin::Scene sceneAt(double time_s, const twin::MachineDescription& machine,
                                    const twin::WebDescription& web,
                                    const Eigen::AlignedBox2d& unit_S_mm) const;
  /// All that was burnt, drawn back to the middle of the belt: in the end it may have left the machine. The
  /// beam is off. @throws std::logic_error if empty.
  [[nodiscard]] twin::Scene finishedSheet(const twin::MachineDescription& machine,
                                          const twin::WebDescription& web,
                                          const Eigen::AlignedBox2d& unit_S_mm) const;

 private:
  /// The pose and the beam, in numbers alone so that a file can hold them.
  struct Frame {
    using Pair = std::array<double, 2>;
    double time_s{};
    double roller_mm{}, belt_travel_mm{};
    Pair sheet_slip_mm{}, frame_mm{}, gantry_mm{}, mirror_rad{};
    Pair p_WQ_mm{};
    double emitted_j{};
    bool lit{};  ///< Since the frame before.
  };
  static twin::MachinePose poseOf(const Frame& frame);

  [[nodiscard]] std::size_t indexAt(double time_s) const;
  [[nodiscard]] twin::SceneContent contentUpTo(std::size_t last, const twin::WebDescription& web,
                                               const Eigen::AlignedBox2d& unit_S_mm) const;
  [[nodiscard]] Eigen::Vector2d spotOnBelt_mm(std::size_t index) const;

  double lit_w_;
  base::SpilledVector<Frame> frames_;
};

}  // namespace kerfbench::run
