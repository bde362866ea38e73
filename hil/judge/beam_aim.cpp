// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/beam_aim.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "firmware_under_test/planner/head/axes.h"
#include "hil/judge/pin_wiring.h"

namespace kerfbench::judge {
namespace {

/// Mirrors and slides follow their pulses by no more than this, or twice what the controller was told.
constexpr double kLag_s = 1e-3;
constexpr unsigned kLooksInMemory = 1024;
constexpr int kInstants = 5;  // The path between them is nearly straight.

std::shared_ptr<SharedSteps> shared(std::optional<evidence::CountedSteps> steps) {
  return steps ? std::make_shared<SharedSteps>(std::move(*steps)) : nullptr;
}

}  // namespace

std::shared_ptr<SharedSteps> stepsOf(const scenario::Case& test_case, const source::PinRecording& recording) {
  return shared(evidence::CountedSteps::of(recording, pinWiring(test_case)));
}

std::shared_ptr<SharedSteps> stepsFrom(const scenario::Case& test_case, TickRate rate) {
  return shared(evidence::CountedSteps::from(rate, pinWiring(test_case)));
}

std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& steps)> placeOfSteps(
    const scenario::Case& test_case) {
  const auto axes =
      std::make_shared<const planner::Axes>(scenario::plannerMachine(test_case), planner::PlannerFaults{});
  const twin::MachineDescription& machine = test_case.machine;
  const bool is_gantry = machine.kind == twin::MachineDescription::Kind::kGantry;
  const double told = is_gantry ? machine.controller.gantry_step_mm : machine.controller.mirror_step_rad;
  // Firmware that the planner does not plan for was told nothing, and has the steps of its drives.
  const Eigen::Vector2d scale = Eigen::Vector2d(is_gantry ? machine.gantry_x.step : machine.galvo_x.step,
                                                is_gantry ? machine.gantry_y.step : machine.galvo_y.step) /
                                told;
  return [axes, scale](const Eigen::Vector2d& steps) -> std::optional<Eigen::Vector2d> {
    try {
      return axes->placeAt(steps.cwiseProduct(scale));
    } catch (const planner::PlanError&) {
      return std::nullopt;  // Beyond the table.
    }
  };
}

vision::BeamAim beamAim(const scenario::Case& test_case, std::shared_ptr<const SharedSteps> steps) {
  if (!steps || !(test_case.machine.spot_camera.read_out.row_s > 0.0)) return {};
  const auto looks = std::make_shared<std::atomic<unsigned>>();
  const double lag_s = std::max(kLag_s, 2.0 * test_case.machine.controller.tracking_delay_s);
  return [steps = std::move(steps), place = placeOfSteps(test_case), looks, lag_s](
             double from_s, double to_s) -> std::optional<Eigen::AlignedBox2d> {
    Eigen::AlignedBox2d box_W_mm;
    const double first_s = from_s - lag_s;
    // Frames come nearly in order of time.
    if (++*looks % kLooksInMemory == 0) steps->passed(first_s);
    for (int i = 0; i < kInstants; ++i) {
      const auto [x, y] = steps->at(first_s + (to_s - first_s) * i / (kInstants - 1));
      const std::optional<Eigen::Vector2d> p_W_mm = place(Eigen::Vector2d(x, y));
      if (!p_W_mm) return std::nullopt;
      box_W_mm.extend(*p_W_mm);
    }
    return box_W_mm;
  };
}

}  // namespace kerfbench::judge
