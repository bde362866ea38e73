// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/part_flow.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "twin/base/constants.h"

namespace kerfbench::twin {
namespace {

constexpr std::size_t kMostSteppers = 4;
constexpr int kRungeKuttaHalvings = 3;  // Runge-Kutta takes stretches of step / 8 or shorter.

}  // namespace

PartFlow::PartFlow(MechanismPart part, double step_s)
    : part_(std::move(part)),
      step_s_(step_s),
      states_(part_.law.stateSize()),
      u_begin_(part_.law.inputs, 0.0),
      u_end_(part_.law.inputs, kNan),  // No command is as before the first step.
      pieces_(part_.law.pieceCount(), 0),
      stage_(states_, 0.0),
      force_(part_.law.joints, 0.0),
      u_stage_(part_.law.inputs, 0.0) {
  findKinks();
  if (part_.law.steppers.size() > kMostSteppers) throw std::invalid_argument("PartFlow: too many steppers");
  const std::size_t columns = states_ + 1 + part_.law.inputs + part_.law.steppers.size();
  const std::size_t room = std::max(columns, LinearFlow::kMostRows);
  memory_.assign(2 * room, 0.0);
  state_ = memory_.data();
  next_ = state_ + room;
  std::ranges::copy(part_.start, state_);
  rates_.fill(std::vector<double>(states_, 0.0));
  for (const StepperLaw& stepper : part_.law.steppers) teeth_.push_back({stepper.pitch(), 0});
}

void PartFlow::findKinks() {
  const ForceLaw& law = part_.law;
  kinked_.joints = law.joints;
  std::size_t piece = 0;
  for (const SpringLaw& spring : law.springs) {
    if (spring.half_play > 0) {
      kinked_.springs.push_back(spring);
      kinks_.push_back(piece);
    }
    ++piece;
  }
  for (const FrictionLaw& friction : law.frictions) {
    if (friction.limit > 0) {
      kinked_.frictions.push_back(friction);
      kinks_.push_back(piece);
    }
    ++piece;
  }
  for (const ServoLaw& servo : law.servos) {
    if (servo.limited) {
      kinked_.servos.push_back(servo);
      kinks_.insert(kinks_.end(), {piece, piece + 1});
    }
    piece += 2;
  }
  kink_pieces_.assign(kinks_.size(), 0);
}

bool PartFlow::staysAt(const double* x, const double* u) const {
  return kinked_.isIn(x, u, regime_->pieces.data());
}

PartFlow::Regime& PartFlow::regimeAt(const double* x, const double* u) {
  kinked_.observe(x, u, kink_pieces_.data());
  const auto known = std::ranges::find_if(regimes_, [&](const auto& r) { return r->pieces == kink_pieces_; });
  if (known != regimes_.end()) return **known;
  regimes_.push_back(std::make_unique<Regime>());
  Regime& regime = *regimes_.back();
  regime.pieces = kink_pieces_;
  setPieces(regime);
  regime.affine = part_.law.isAffine(pieces_.data());
  return regime;
}

const LinearFlow* PartFlow::newFlow(int halvings) {
  if (!regime_->affine) return nullptr;
  setPieces(*regime_);
  std::unique_ptr<LinearFlow>& flow = regime_->flows[static_cast<std::size_t>(halvings)];
  flow = makeFlow(std::ldexp(step_s_, -halvings));
  return flow.get();
}

void PartFlow::setPieces(const Regime& regime) {
  for (std::size_t i = 0; i < kinks_.size(); ++i) pieces_[kinks_[i]] = regime.pieces[i];
}

std::unique_ptr<LinearFlow> PartFlow::makeFlow(double step_s) const {
  const AffineRate affine = affineRate(part_.law, part_.inverse_mass, pieces_.data());
  const auto n = static_cast<Eigen::Index>(states_);
  const auto joints = static_cast<Eigen::Index>(part_.law.joints);
  const auto inputs = static_cast<Eigen::Index>(part_.law.inputs);
  const auto fields = static_cast<Eigen::Index>(teeth_.size());
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(n, 1 + inputs + fields);
  B.col(0) = affine.c;
  B.middleCols(1, inputs) = affine.B;
  for (Eigen::Index i = 0; i < fields; ++i) {
    const std::size_t joint = part_.law.steppers[static_cast<std::size_t>(i)].joint;
    B.col(1 + inputs + i).segment(joints, joints) = part_.inverse_mass.col(static_cast<Eigen::Index>(joint));
  }
  return std::make_unique<LinearFlow>(affine.A, B, step_s);
}

void PartFlow::meetTeeth() {
  for (std::size_t i = 0; i < teeth_.size(); ++i) {
    const StepperLaw& law = part_.law.steppers[i];
    Field& field = teeth_[i];
    const double lag = q()[law.joint] - u_end_[law.input] - law.offset;
    const double teeth = lag / field.pitch;
    if (std::abs(teeth - static_cast<double>(field.tooth)) > 0.5) field.tooth = std::llround(teeth);
    inputs()[law.input] = u_end_[law.input] + static_cast<double>(field.tooth) * field.pitch;
    fields()[i] = beyondSpring(law, q()[law.joint], v()[law.joint]);
  }
}

double PartFlow::beyondSpring(const StepperLaw& law, double q, double v) {
  return law.fieldTorque(q, v, u_end_[law.input]) - law.springTorque(q, inputs()[law.input]);
}

void PartFlow::addFields(const LinearFlow& flow, double step_s) {
  // All values come from the predicted state, so that no stepper of a part precedes another.
  std::array<double, kMostSteppers> ramp{};
  std::array<double, kMostSteppers> bend{};
  for (std::size_t i = 0; i < teeth_.size(); ++i) {
    const StepperLaw& law = part_.law.steppers[i];
    const double q0 = q()[law.joint];
    const double v0 = v()[law.joint];
    const double q1 = next_[law.joint];
    const double v1 = next_[part_.law.joints + law.joint];
    // The middle of the cubic with these ends.
    const double q_middle = 0.5 * (q0 + q1) + 0.125 * step_s * (v0 - v1);
    const double v_middle = 1.5 * (q1 - q0) / step_s - 0.25 * (v0 + v1);
    const double begin = fields()[i];
    const double middle = beyondSpring(law, q_middle, v_middle);
    const double end = beyondSpring(law, q1, v1);
    ramp.at(i) = 4.0 * middle - 3.0 * begin - end;
    bend.at(i) = 2.0 * (begin - 2.0 * middle + end);
  }
  for (std::size_t i = 0; i < teeth_.size(); ++i) {
    const std::size_t input = 1 + part_.law.inputs + i;
    flow.addRamp(input, ramp.at(i), next_);
    flow.addBend(input, bend.at(i), next_);
  }
}

std::size_t PartFlow::run(std::size_t steps, std::span<const DriveCommand> commands, std::size_t drives) {
  for (std::size_t k = 0; k < steps; ++k) {
    step(commands.data() + k * drives);
    if (!sane()) return k;
  }
  return steps;
}

bool PartFlow::sane() const {
  for (std::size_t i = 0; i < part_.law.joints; ++i) {
    // The condition is written so that NaN is beyond.
    if (!(std::abs(v()[i]) <= part_.most_speeds[i]) || !std::isfinite(q()[i])) return false;
  }
  return true;
}

void PartFlow::step(const DriveCommand* commands) {
  commands_ = commands;
  bool moved = regime_ == nullptr;
  for (std::size_t i = 0; i < part_.drives.size(); ++i) {
    const DriveCommand& command = commands[part_.drives[i]];
    moved = moved || command.begin != u_end_[i];
    u_begin_[i] = command.begin;
    u_end_[i] = command.end;
  }
  // A step begins where the last one ended; only pulses between them may change the regime.
  if (moved && (regime_ == nullptr || !staysAt(state_, u_begin_.data()))) {
    regime_ = &regimeAt(state_, u_begin_.data());
  }
  if (cross({0.0, 0})) return;
  ++halved_;
  crossInHalves({0.0, 0}, regime_->affine ? kinkPlace() : kNowhere);
}

double PartFlow::kinkPlace() {
  constexpr int kStretches = 1 << kHalvings;
  const std::size_t n = part_.law.joints;
  int before = 0;
  int after = kStretches;
  while (after - before > 1) {
    const int middle = (before + after) / 2;
    const double share = static_cast<double>(middle) / kStretches;
    for (std::size_t i = 0; i < states_; ++i) stage_[i] = state_[i] + share * (next_[i] - state_[i]);
    // Positions bend: the cubic with the speeds at both ends.
    for (std::size_t i = 0; i < n; ++i) {
      const double mean = (next_[i] - state_[i]) / step_s_;
      const double bend = (1.0 - share) * (state_[n + i] - mean) - share * (next_[n + i] - mean);
      stage_[i] += step_s_ * share * (1.0 - share) * bend;
    }
    commandsAt(share, u_stage_);
    (staysAt(stage_.data(), u_stage_.data()) ? before : after) = middle;
  }
  return (before + 0.5) / kStretches;
}

void PartFlow::commandsAt(double share, std::vector<double>& u) const {
  for (std::size_t i = 0; i < u.size(); ++i) {
    const DriveCommand& command = commands_[part_.drives[i]];
    u[i] = share == 1.0 ? command.end : command.begin + share * (command.end - command.begin);
  }
}

bool PartFlow::cross(const Stretch& stretch) {
  if (!propagate(stretch)) return false;
  const bool stays = staysAt(next_, u_end_.data());
  if (!stays && stretch.halvings < kHalvings) return false;
  std::swap(state_, next_);
  if (!stays) regime_ = &regimeAt(state_, u_end_.data());
  return true;
}

void PartFlow::crossInHalves(const Stretch& stretch, double aim) {
  Stretch half{stretch.from, stretch.halvings + 1};
  for (int i = 0; i < 2; ++i, half.from += half.share()) {
    if (half.halvings < kHalvings && half.holds(aim)) {
      crossInHalves(half, aim);
      continue;
    }
    commandsAt(half.from, u_begin_);
    commandsAt(half.from + half.share(), u_end_);
    if (!cross(half)) crossInHalves(half, kNowhere);
  }
}

bool PartFlow::propagate(const Stretch& stretch) {
  const LinearFlow* flow = regime_->flows[static_cast<std::size_t>(stretch.halvings)].get();
  if (flow == nullptr) flow = newFlow(stretch.halvings);
  if (flow == nullptr) {
    if (stretch.halvings < kRungeKuttaHalvings) return false;
    rungeKutta(stretch);
    return true;
  }
  state_[states_] = 1.0;
  for (std::size_t i = 0; i < u_begin_.size(); ++i) inputs()[i] = u_begin_[i];
  if (!teeth_.empty()) meetTeeth();
  flow->advance(state_, next_);
  for (std::size_t i = 0; i < u_end_.size(); ++i) {
    if (u_end_[i] != u_begin_[i]) flow->addRamp(1 + i, u_end_[i] - u_begin_[i], next_);
  }
  if (!teeth_.empty()) addFields(*flow, step_s_ * stretch.share());
  return true;
}

void PartFlow::rate(const double* x, const double* u, double* rate) {
  const std::size_t n = part_.law.joints;
  part_.law.evaluate(x, u, force_.data(), rate + 2 * n);
  std::copy_n(x + n, n, rate);
  for (std::size_t i = 0; i < n; ++i) {
    double acceleration = 0.0;
    for (std::size_t j = 0; j < n; ++j) {
      acceleration +=
          part_.inverse_mass(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * force_[j];
    }
    rate[n + i] = acceleration;
  }
}

void PartFlow::rungeKutta(const Stretch& stretch) {
  const double h = step_s_ * stretch.share();
  const auto stage = [&](const std::vector<double>& from_rate, double by_s) {
    for (std::size_t i = 0; i < states_; ++i) stage_[i] = state_[i] + by_s * from_rate[i];
  };
  commandsAt(stretch.from + 0.5 * stretch.share(), u_stage_);
  rate(state_, u_begin_.data(), rates_[0].data());
  stage(rates_[0], 0.5 * h);
  rate(stage_.data(), u_stage_.data(), rates_[1].data());
  stage(rates_[1], 0.5 * h);
  rate(stage_.data(), u_stage_.data(), rates_[2].data());
  stage(rates_[2], h);
  rate(stage_.data(), u_end_.data(), rates_[3].data());
  for (std::size_t i = 0; i < states_; ++i) {
    next_[i] = state_[i] + h / 6.0 * (rates_[0][i] + 2.0 * (rates_[1][i] + rates_[2][i]) + rates_[3][i]);
  }
}

}  // namespace kerfbench::twin
