// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/fast_solver.h"

#include <utility>

namespace kerfbench::twin {

FastSolver::FastSolver(std::shared_ptr<const Mechanism> mechanism, double step_s)
    : mechanism_(std::move(mechanism)),
      step_s_(step_s),
      q_(mechanism_->law().joints, 0.0),
      v_(mechanism_->law().joints, 0.0) {
  mechanism_->requireSlowerThan(step_s_);
  for (MechanismPart& part : partsOf(*mechanism_)) parts_.emplace_back(std::move(part), step_s_);
  gather();
}

void FastSolver::gather() {
  for (const PartFlow& flow : parts_) {
    const std::vector<std::size_t>& joints = flow.part().joints;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      q_[joints[i]] = flow.q()[i];
      v_[joints[i]] = flow.v()[i];
    }
  }
}

void FastSolver::step(double begin_s, std::span<const DriveCommand> commands) {
  for (PartFlow& flow : parts_) flow.step(commands);
  gather();
  requireSane(*mechanism_, q_, v_, begin_s + step_s_);
}

std::uint64_t FastSolver::halved() const {
  std::uint64_t count = 0;
  for (const PartFlow& flow : parts_) count += flow.halved();
  return count;
}

}  // namespace kerfbench::twin
