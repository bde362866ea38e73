// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/spot_track.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/benchmarks/bullet_world.h"
#include "twin/cutter/machine_model.h"
#include "twin/machine/reference_solver.h"
#include "twin/optics/scan_head.h"

namespace kerfbench::benchmarks {
namespace {

using twin::Axis;
using twin::MachineModel;

constexpr double kExactStep_s = 1e-6;
constexpr double kSample_s = MachineModel::kStep_s;

struct AxisPins {
  Axis axis;
  Signal pul, dir;
};
constexpr AxisPins kMirrors[] = {{Axis::kGalvoX, Signal::kGalvoXPul, Signal::kGalvoXDir},
                                 {Axis::kGalvoY, Signal::kGalvoYPul, Signal::kGalvoYDir}};

std::vector<twin::StepEdge> decoded(const RecordedRun& run, const AxisPins& pins) {
  const PinId pul = run.machine.signals.pin(pins.pul).value();
  const PinId dir = run.machine.signals.pin(pins.dir).value();
  if (pul.port != dir.port) throw std::invalid_argument("PUL and DIR on one port, please");
  twin::PulseDecoder decoder(twin::axisOf(run.machine, pins.axis).profile);
  std::vector<twin::StepEdge> steps;
  const auto level = [](const PinEvent& event, PinId pin) {
    return ((static_cast<unsigned>(event.level) >> pin.bit) & 1U) != 0;
  };
  for (const PinEvent& event : run.events) {
    if (event.port != pul.port) continue;
    decoder.levels(run.rate.seconds(event.tick), level(event, pul), level(event, dir), steps);
  }
  return steps;
}

/// Turns mechanism states into spots, and times into the line's command.
class Head {
 public:
  explicit Head(const Stretch& stretch)
      : parts_(twin::mechanismOf(stretch.machine, stretch.web)),
        mechanism_(std::make_shared<const twin::Mechanism>(parts_.description)),
        head_(stretch.machine.head, stretch.machine.beam),
        surface_(stretch.machine.surface),
        line_rad_s_(stretch.web.belt_speed_mm_s / stretch.machine.belt.roller_radius_mm) {
    if (!stretch.web.belt_speed_changes.empty() || stretch.web.fed_by_controller) {
      throw std::invalid_argument("a belt at constant speed, please");
    }
  }
  [[nodiscard]] const twin::MachineMechanism& parts() const { return parts_; }
  [[nodiscard]] const std::shared_ptr<const twin::Mechanism>& mechanism() const { return mechanism_; }
  [[nodiscard]] double line_rad(double time_s) const { return line_rad_s_ * (time_s - parts_.line_delay_s); }
  [[nodiscard]] Eigen::Vector2d spot_mm(std::span<const double> q, double time_s) const {
    const Eigen::Vector2d mirrors(q[*parts_.head_x], q[*parts_.head_y]);
    const Eigen::Vector2d frame_mm = parts_.frame_x
                                         ? Eigen::Vector2d(1e3 * q[*parts_.frame_x], 1e3 * q[*parts_.frame_y])
                                         : Eigen::Vector2d::Zero();
    const auto spot = head_.spotAt(mirrors, frame_mm, surface_, time_s);
    return spot ? spot->p_WQ_mm : Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }

 private:
  twin::MachineMechanism parts_;
  std::shared_ptr<const twin::Mechanism> mechanism_;
  twin::ScanHead head_;
  twin::Surface surface_;
  double line_rad_s_;
};

/// Area means of the step inputs over steps of any length.
class Inputs {
 public:
  Inputs(const Stretch& stretch, const Head& head) : head_(head) {
    for (const auto& drive : head.parts().pulse_drives) {
      commands_.emplace_back(drive.motor_per_step);
      commands_.back().incoming() = stretch.steps[static_cast<std::size_t>(drive.axis)];
    }
    values_.resize(head.parts().description.drives.size());
  }
  std::span<const double> over(double begin_s, double end_s) {
    for (std::size_t i = 0; i < commands_.size(); ++i) {
      const double delay_s = head_.parts().pulse_drives[i].input_delay_s;
      values_[i] = commands_[i].meanOver(begin_s - delay_s, end_s - delay_s);
    }
    if (head_.parts().line_drive) values_.back() = head_.line_rad(0.5 * (begin_s + end_s));
    return values_;
  }

 private:
  const Head& head_;
  std::vector<twin::PulseCommand> commands_;
  std::vector<double> values_;
};

/// Instants at which a command changes, delays included, and the instants of the samples.
std::vector<double> instants(const Stretch& stretch, const Head& head) {
  std::vector<double> times;
  for (int k = 1; k * kSample_s <= stretch.length_s + 1e-12; ++k) times.push_back(k * kSample_s);
  for (const auto& drive : head.parts().pulse_drives) {
    for (const twin::StepEdge& step : stretch.steps[static_cast<std::size_t>(drive.axis)]) {
      times.push_back(step.time_s + drive.input_delay_s);
    }
  }
  std::ranges::sort(times);
  return times;
}

}  // namespace

Stretch stretchOf(const RecordedRun& run, double length_s) {
  Stretch stretch{run.machine, run.web, {}, length_s};
  constexpr double kBefore_s = 0.2e-3;
  double first_s = std::numeric_limits<double>::infinity();
  for (const AxisPins& pins : kMirrors) {
    auto& steps = stretch.steps[static_cast<std::size_t>(pins.axis)];
    steps = decoded(run, pins);
    if (!steps.empty()) first_s = std::min(first_s, steps.front().time_s);
  }
  if (!std::isfinite(first_s)) throw std::invalid_argument(run.name + ": no mirror moves");
  for (auto& steps : stretch.steps) {
    for (twin::StepEdge& step : steps) step.time_s -= first_s - kBefore_s;
    std::erase_if(steps, [&](const auto& step) { return step.time_s >= length_s; });
  }
  return stretch;
}

SpotTrack exactTrack(const Stretch& stretch) {
  const Head head(stretch);
  Inputs inputs(stretch, head);
  twin::ReferenceSolver solver(head.mechanism(), kExactStep_s);
  std::vector<twin::DriveCommand> commands(head.parts().description.drives.size());
  SpotTrack track;
  double now_s = 0.0;
  for (const double next_s : instants(stretch, head)) {
    while (now_s < next_s) {
      const double to_s = next_s - now_s <= 1.001 * kExactStep_s ? next_s : now_s + kExactStep_s;
      const auto values = inputs.over(now_s, to_s);
      for (std::size_t i = 0; i < commands.size(); ++i) commands[i] = {values[i], values[i], values[i]};
      if (head.parts().line_drive)
        commands.back() = {head.line_rad(now_s), values.back(), head.line_rad(to_s)};
      solver.stepBy(now_s, std::min(kExactStep_s, to_s - now_s), commands);
      now_s = to_s;
    }
    const double due_s = static_cast<double>(track.size() + 1) * kSample_s;
    if (now_s >= due_s - 1e-12) track.push_back(head.spot_mm(solver.q(), now_s));
  }
  return track;
}

SpotTrack twinTrack(const Stretch& stretch, twin::Fidelity fidelity) {
  MachineModel model(stretch.machine, stretch.web, fidelity);
  for (std::size_t axis = 0; axis < twin::kAxisCount; ++axis) {
    model.command(static_cast<Axis>(axis)).incoming() = stretch.steps[axis];
  }
  SpotTrack track;
  for (int k = 0; (k + 1) * kSample_s <= stretch.length_s + 1e-12; ++k) {
    model.run(static_cast<std::uint64_t>(k), 1);
    track.push_back(model.spot().value().p_WQ_mm);
  }
  return track;
}

struct BulletMachine::Parts {
  Parts(const Stretch& stretch, double step)
      : head(stretch), inputs(stretch, head), world(head.mechanism()), step_s(step) {}
  Head head;
  Inputs inputs;
  BulletWorld world;
  double step_s;
  long long steps{0};
};

BulletMachine::BulletMachine(const Stretch& stretch, double step_s)
    : parts_(std::make_unique<Parts>(stretch, step_s)) {}
BulletMachine::~BulletMachine() = default;

void BulletMachine::step() {
  const double begin_s = time_s();
  ++parts_->steps;
  parts_->world.step(parts_->step_s, parts_->inputs.over(begin_s, time_s()));
}

double BulletMachine::time_s() const { return static_cast<double>(parts_->steps) * parts_->step_s; }
std::size_t BulletMachine::joints() const { return parts_->head.mechanism()->law().joints; }
Eigen::Vector2d BulletMachine::spot_mm() const { return parts_->head.spot_mm(parts_->world.q(), time_s()); }

SpotTrack bulletTrack(const Stretch& stretch, double step_s) {
  BulletMachine machine(stretch, step_s);
  const auto per_sample = std::llround(kSample_s / step_s);
  SpotTrack track;
  while (machine.time_s() + kSample_s <= stretch.length_s + 1e-12) {
    for (long long i = 0; i < per_sample; ++i) machine.step();
    track.push_back(machine.spot_mm());
  }
  return track;
}

double largestError_mm(const SpotTrack& track, const SpotTrack& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < std::min(track.size(), truth.size()); ++i) {
    const double error = (track[i] - truth[i]).norm();
    if (!(error <= worst)) worst = error;
  }
  return worst;
}

}  // namespace kerfbench::benchmarks
