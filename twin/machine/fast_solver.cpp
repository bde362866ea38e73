// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/fast_solver.h"

#include <algorithm>
#include <utility>

namespace kerfbench::twin {

FastSolver::FastSolver(std::shared_ptr<const Mechanism> mechanism, double step_s)
    : mechanism_(std::move(mechanism)),
      step_s_(step_s),
      q_(mechanism_->law().joints, 0.0),
      v_(mechanism_->law().joints, 0.0) {
  mechanism_->requireSlowerThan(step_s_);
  for (MechanismPart& part : partsOf(*mechanism_)) parts_.emplace_back(std::move(part), step_s_);
  for (const PartFlow& flow : parts_) gather(flow);
  made_.assign(parts_.size(), 0);
}

void FastSolver::gather(const PartFlow& flow) {
  const std::vector<std::size_t>& joints = flow.part().joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    q_[joints[i]] = flow.q()[i];
    v_[joints[i]] = flow.v()[i];
  }
}

void FastSolver::run(double begin_s, std::size_t steps, std::span<const DriveCommand> commands) {
  std::size_t sane = steps;  // Steps that all parts make before the first one diverges.
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    made_[i] = parts_[i].run(steps, commands, mechanism_->law().inputs);
    sane = std::min(sane, made_[i]);
  }
  // Where one diverges, the others are ahead of it and of no interest.
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (made_[i] == sane) gather(parts_[i]);
  }
  if (sane < steps) requireSane(*mechanism_, q_, v_, begin_s + static_cast<double>(sane + 1) * step_s_);
}

std::uint64_t FastSolver::halved() const {
  std::uint64_t count = 0;
  for (const PartFlow& flow : parts_) count += flow.halved();
  return count;
}

}  // namespace kerfbench::twin
