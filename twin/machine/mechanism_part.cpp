// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/mechanism_part.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

namespace kerfbench::twin {
namespace {

Eigen::Index at(std::size_t index) { return static_cast<Eigen::Index>(index); }

// Joints that can ever move: those that move at the start, and those that a force reaches.
class Reach {
 public:
  explicit Reach(const Mechanism& mechanism)
      : mechanism_(mechanism),
        law_(mechanism.law()),
        start_(mechanism.startState()),
        moves_(law_.joints, false),
        forced_(law_.joints, false) {
    for (std::size_t i = 0; i < law_.joints; ++i) {
      moves_[i] = start_[law_.joints + i] != 0;
      forced_[i] = mechanism_.gravity()[at(i)] != 0;
    }
    for (const ConstantForce& c : law_.constants) forced_[c.joint] = forced_[c.joint] || c.force != 0;
    for (const ServoLaw& s : law_.servos) forced_[s.joint] = true;
    for (const StepperLaw& s : law_.steppers) forced_[s.joint] = true;
    while (spread()) {
    }
  }
  [[nodiscard]] const std::vector<bool>& moves() const { return moves_; }

 private:
  [[nodiscard]] bool loaded(std::size_t auxiliary) const { return start_[2 * law_.joints + auxiliary] != 0; }

  bool spread() {
    const auto before = std::pair(moves_, forced_);
    for (const SpringLaw& s : law_.springs) {
      if (moves_[s.a] || moves_[s.b] || s.rest != 0) forced_[s.a] = forced_[s.b] = true;
    }
    for (const FrictionLaw& f : law_.frictions) {
      const bool bristle = f.limit > 0;
      if (moves_[f.joint] || (bristle && loaded(f.bristle))) forced_[f.joint] = true;
      // Friction along never pushes across.
      if (f.plane && (moves_[f.across] || (bristle && loaded(f.bristle + 1)))) forced_[f.across] = true;
    }
    for (std::size_t j = 0; j < law_.joints; ++j) {
      if (!forced_[j]) continue;
      for (std::size_t i = 0; i < law_.joints; ++i) {
        if (mechanism_.inverseMass()(at(i), at(j)) != 0) moves_[i] = true;
      }
    }
    return before != std::pair(moves_, forced_);
  }

  const Mechanism& mechanism_;
  const ForceLaw& law_;
  std::vector<double> start_;
  std::vector<bool> moves_, forced_;
};

// Finds for each joint the lowest joint of its part.
std::vector<std::size_t> groupsOf(const Mechanism& mechanism, const std::vector<bool>& moves) {
  const ForceLaw& law = mechanism.law();
  std::vector<std::size_t> group(law.joints);
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto tie = [&](std::size_t a, std::size_t b) {
    if (!moves[a] || !moves[b]) return;
    const std::size_t to = std::min(group[a], group[b]);
    const std::size_t from = std::max(group[a], group[b]);
    std::ranges::replace(group, from, to);
  };
  for (const SpringLaw& s : law.springs) tie(s.a, s.b);
  for (const FrictionLaw& f : law.frictions) tie(f.joint, f.across);
  for (std::size_t i = 0; i < law.joints; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (mechanism.inverseMass()(at(i), at(j)) != 0) tie(i, j);
    }
  }
  return group;
}

class PartMaker {
 public:
  PartMaker(const Mechanism& mechanism, std::vector<std::size_t> joints)
      : whole_(mechanism.law()), whole_start_(mechanism.startState()), local_(whole_.joints, kNone) {
    part_.joints = std::move(joints);
    const std::size_t n = part_.joints.size();
    part_.law.joints = n;
    part_.inverse_mass.resize(at(n), at(n));
    for (std::size_t i = 0; i < n; ++i) {
      local_[part_.joints[i]] = i;
      part_.start.push_back(0.0);
      for (std::size_t j = 0; j < n; ++j) {
        part_.inverse_mass(at(i), at(j)) = mechanism.inverseMass()(at(part_.joints[i]), at(part_.joints[j]));
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      part_.start.push_back(whole_start_[whole_.joints + part_.joints[i]]);
      part_.most_speeds.push_back(mechanism.mostSpeeds()[part_.joints[i]]);
      const double weight = mechanism.gravity()[at(part_.joints[i])];
      if (weight != 0) part_.law.constants.push_back({i, weight});
    }
  }

  MechanismPart make() {
    for (ConstantForce c : whole_.constants) {
      if (take(c.joint)) part_.law.constants.push_back(c);
    }
    addSprings();
    addFrictions();
    addDrives();
    part_.law.inputs = part_.drives.size();
    return std::move(part_);
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  // Turns a joint of the whole into one of the part.
  bool take(std::size_t& joint) const {
    if (local_[joint] == kNone) return false;
    joint = local_[joint];
    return true;
  }
  std::size_t auxiliary(std::size_t of_whole) {
    part_.start.push_back(whole_start_[2 * whole_.joints + of_whole]);
    return part_.law.auxiliaries++;
  }
  std::size_t input(std::size_t of_whole) {
    part_.drives.push_back(of_whole);
    return part_.drives.size() - 1;
  }

  void addSprings() {
    for (SpringLaw s : whole_.springs) {
      // A spring forces both its ends: either both move or neither.
      if (!take(s.a) || !take(s.b)) continue;
      part_.law.springs.push_back(s);
    }
  }
  void addFrictions() {
    for (FrictionLaw f : whole_.frictions) {
      std::size_t bristle = f.bristle;
      const bool along = take(f.joint);
      const bool across = f.plane && take(f.across);
      if (!along && !across) continue;
      if (f.plane && !(along && across)) {
        if (across) {
          f.joint = f.across;
          ++bristle;
        }
        f.plane = false;
      }
      if (!f.plane) f.across = f.joint;
      if (f.limit > 0) {
        f.bristle = auxiliary(bristle);
        if (f.plane) (void)auxiliary(bristle + 1);
      }
      part_.law.frictions.push_back(f);
    }
  }
  void addDrives() {
    for (ServoLaw s : whole_.servos) {
      if (!take(s.joint)) continue;
      s.input = input(s.input);
      if (s.feedforward > 0) s.filter = auxiliary(s.filter);
      if (s.lag_s > 0) s.current = auxiliary(s.current);
      part_.law.servos.push_back(s);
    }
    for (StepperLaw s : whole_.steppers) {
      if (!take(s.joint)) continue;
      s.input = input(s.input);
      part_.law.steppers.push_back(s);
    }
  }

  const ForceLaw& whole_;
  std::vector<double> whole_start_;
  std::vector<std::size_t> local_;
  MechanismPart part_;
};

}  // namespace

std::vector<MechanismPart> partsOf(const Mechanism& mechanism) {
  const std::vector<bool> moves = Reach(mechanism).moves();
  const std::vector<std::size_t> group = groupsOf(mechanism, moves);
  std::vector<MechanismPart> parts;
  for (std::size_t first = 0; first < group.size(); ++first) {
    std::vector<std::size_t> joints;
    for (std::size_t i = first; i < group.size(); ++i) {
      if (moves[i] && group[i] == first) joints.push_back(i);
    }
    if (!joints.empty()) parts.push_back(PartMaker(mechanism, std::move(joints)).make());
  }
  return parts;
}

}  // namespace kerfbench::twin
