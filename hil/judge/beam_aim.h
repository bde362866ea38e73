// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include "hil/evidence/counted_steps.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"
#include "hil/vision/spot/spot_track.h"

namespace kerfbench::judge {

/// Steps that one thread counts while a run goes on, and another aims by.
class SharedSteps {
 public:
  explicit SharedSteps(evidence::CountedSteps steps) : steps_(std::move(steps)) {}
  void add(std::span<const PinEvent> events, Tick until) {
    const std::scoped_lock lock(mutex_);
    steps_.add(events, until);
  }
  void end() {
    const std::scoped_lock lock(mutex_);
    steps_.end();
  }
  [[nodiscard]] evidence::CountedSteps::Steps at(double time_s) const {
    const std::scoped_lock lock(mutex_);
    return steps_.at(time_s);
  }
  void passed(double time_s) const {
    const std::scoped_lock lock(mutex_);
    steps_.passed(time_s);
  }

 private:
  mutable std::mutex mutex_;
  evidence::CountedSteps steps_;
};

/// Place of the beam in W, mm, for steps of the head's axes: by the steps of the machine as it is described,
/// and by what the controller was told of the rest of its head. Nullopt beyond the correction table.
std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& steps)> placeOfSteps(
    const scenario::Case& test_case);

/// Where the spot camera is to look: the steps that the pins have asked for, by placeOfSteps(). Empty, so
/// that the camera is read out whole, if its machine file tells no read-out or `steps` is null. It may be
/// asked for times up to which steps were added.
vision::BeamAim beamAim(const scenario::Case& test_case, std::shared_ptr<const SharedSteps> steps);

/// Steps of a recording. Null if an axis is not wired.
std::shared_ptr<SharedSteps> stepsOf(const scenario::Case& test_case, const source::PinRecording& recording);
/// Steps of a run that begins: none yet.
std::shared_ptr<SharedSteps> stepsFrom(const scenario::Case& test_case, TickRate rate);

}  // namespace kerfbench::judge
