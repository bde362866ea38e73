// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/part_flow.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace kerfbench::twin {
namespace {

// Number of pieces, -2 … 2 of each element: a regime's key counts them as digits.
constexpr std::uint64_t kPieces = 5;
constexpr std::size_t kMostDigits = 27;
constexpr std::size_t kMostSteppers = 4;
constexpr int kRungeKuttaHalvings = 3;  // Runge-Kutta takes stretches of step / 8 or shorter.

}  // namespace

PartFlow::PartFlow(MechanismPart part, double step_s)
    : part_(std::move(part)),
      step_s_(step_s),
      states_(part_.law.stateSize()),
      state_(part_.start),
      u_from_(part_.law.inputs, 0.0),
      u_to_(u_from_),
      u_begin_(u_from_),
      u_end_(u_from_),
      pieces_(part_.law.pieceCount(), 0),
      stage_(states_, 0.0),
      force_(part_.law.joints, 0.0),
      u_stage_(part_.law.inputs, 0.0) {
  findKinks();
  if (kinks_.size() > kMostDigits || part_.law.steppers.size() > kMostSteppers)
    throw std::invalid_argument("PartFlow: too many elements");
  const std::size_t columns = states_ + 1 + part_.law.inputs + part_.law.steppers.size();
  state_.resize(std::max(columns, LinearFlow::kMostRows), 0.0);
  next_ = state_;
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

std::uint64_t PartFlow::regimeAt(const double* x, const double* u) {
  if (kinks_.empty()) return 0;
  kinked_.observe(x, u, kink_pieces_.data());
  std::uint64_t key = 0;
  for (const ForceLaw::Piece piece : kink_pieces_) {
    key = kPieces * key + static_cast<std::uint64_t>(piece + 2);
  }
  return key;
}

std::uint64_t PartFlow::regimeNow() {
  // A stretch ends where the next begins; only pulses between them may change the regime.
  if (u_key_ != u_begin_ || u_key_.empty()) {
    key_ = regimeAt(state_.data(), u_begin_.data());
    u_key_ = u_begin_;
  }
  return key_;
}

PartFlow::Regime& PartFlow::regimeOf(std::uint64_t key) {
  if (last_ != nullptr && last_->key == key) return *last_;
  const auto known = std::ranges::find_if(regimes_, [key](const auto& r) { return r->key == key; });
  if (known != regimes_.end()) {
    last_ = known->get();
    return *last_;
  }
  regimes_.push_back(std::make_unique<Regime>());
  last_ = regimes_.back().get();
  last_->key = key;
  setPieces(key);
  last_->affine = part_.law.isAffine(pieces_.data());
  return *last_;
}

const LinearFlow* PartFlow::flowOf(std::uint64_t key, int halvings) {
  Regime& regime = regimeOf(key);
  if (!regime.affine) return nullptr;
  std::unique_ptr<LinearFlow>& flow = regime.flows.at(static_cast<std::size_t>(halvings));
  if (!flow) {
    setPieces(key);
    flow = makeFlow(std::ldexp(step_s_, -halvings));
  }
  return flow.get();
}

void PartFlow::setPieces(std::uint64_t key) {
  for (std::size_t i = kinks_.size(); i-- > 0; key /= kPieces) {
    pieces_[kinks_[i]] = static_cast<ForceLaw::Piece>(static_cast<int>(key % kPieces) - 2);
  }
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
    flow.addRamp(input, ramp.at(i), next_.data());
    flow.addBend(input, bend.at(i), next_.data());
  }
}

void PartFlow::step(std::span<const DriveCommand> commands) {
  for (std::size_t i = 0; i < u_to_.size(); ++i) {
    const DriveCommand& command = commands[part_.drives[i]];
    u_from_[i] = u_begin_[i] = command.begin;
    u_to_[i] = u_end_[i] = command.end;
  }
  advance({0.0, 0});
}

void PartFlow::commandsAt(double share, std::vector<double>& u) const {
  for (std::size_t i = 0; i < u.size(); ++i) {
    u[i] = share == 1.0 ? u_to_[i] : u_from_[i] + share * (u_to_[i] - u_from_[i]);
  }
}

void PartFlow::advance(const Stretch& stretch) {
  if (stretch.halvings > 0) {
    commandsAt(stretch.from, u_begin_);
    commandsAt(stretch.from + stretch.share(), u_end_);
  }
  const std::uint64_t before = regimeNow();
  if (propagate(stretch, before)) {
    const std::uint64_t after = regimeAt(next_.data(), u_end_.data());
    if (after == before || stretch.halvings == kHalvings) {
      state_.swap(next_);
      key_ = after;
      u_key_ = u_end_;
      return;
    }
  }
  if (stretch.halvings == 0) ++halved_;
  const Stretch half{stretch.from, stretch.halvings + 1};
  advance(half);
  advance({half.from + half.share(), half.halvings});
}

bool PartFlow::propagate(const Stretch& stretch, std::uint64_t key) {
  const LinearFlow* const flow = flowOf(key, stretch.halvings);
  if (flow == nullptr) {
    if (stretch.halvings < kRungeKuttaHalvings) return false;
    rungeKutta(stretch);
    return true;
  }
  state_[states_] = 1.0;
  std::ranges::copy(u_begin_, inputs());
  if (!teeth_.empty()) meetTeeth();
  flow->advance(state_.data(), next_.data());
  for (std::size_t i = 0; i < u_end_.size(); ++i) {
    if (u_end_[i] != u_begin_[i]) flow->addRamp(1 + i, u_end_[i] - u_begin_[i], next_.data());
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
  rate(state_.data(), u_begin_.data(), rates_[0].data());
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
