// SPDX-License-Identifier: Apache-2.0
// Change of energy by a solver, in systems that conserve it, over ten seconds.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "tests/validation/studies.h"
#include "tests/validation/support/solvers.h"
#include "tests/validation/support/svg.h"

namespace kerfbench::validation {
namespace {

constexpr double kEnergyStep_s = 10e-6;
constexpr double kMass_kg = 0.5;

std::shared_ptr<const twin::Mechanism> thrownUp(double speed_m_s) {
  twin::MechanismDescription d;
  twin::JointDescription slide;
  slide.name = "slide";
  slide.kind = twin::JointDescription::Kind::kPrismatic;
  slide.axis = Eigen::Vector3d::UnitZ();
  slide.mass_kg = kMass_kg;
  slide.start_speed = speed_m_s;
  d.joints = {slide};
  return std::make_shared<twin::Mechanism>(std::move(d));
}

std::shared_ptr<const twin::Mechanism> massOnSpring(double hz, double speed_m_s) {
  twin::MechanismDescription d = thrownUp(speed_m_s)->description();
  d.joints[0].axis = Eigen::Vector3d::UnitX();
  twin::CouplingDescription spring;
  spring.stiffness = kMass_kg * std::pow(2.0 * std::numbers::pi * hz, 2);
  d.couplings = {spring};
  return std::make_shared<twin::Mechanism>(std::move(d));
}

struct Drift {
  double worst{};  ///< Largest change of the energy, over its first value.
  double off_m{};  ///< Difference from the closed form at the end.
};

template <typename EnergyFn, typename PlaceFn>
Drift driftOf(const std::shared_ptr<const twin::Mechanism>& mechanism, twin::Fidelity fidelity, double end_s,
              const EnergyFn& energy, const PlaceFn& place_m) {
  const auto solver = solverOf(mechanism, kEnergyStep_s, fidelity);
  const double start_j = energy(solver->q()[0], solver->v()[0]);
  Drift drift;
  const auto steps = std::llround(end_s / kEnergyStep_s);
  for (long long i = 0; i < steps; ++i) {
    solver->step(static_cast<double>(i) * kEnergyStep_s, {});
    const double now_j = energy(solver->q()[0], solver->v()[0]);
    raiseTo(drift.worst, std::abs(now_j - start_j) / start_j);
  }
  drift.off_m = std::abs(solver->q()[0] - place_m(static_cast<double>(steps) * kEnergyStep_s));
  return drift;
}

}  // namespace

Section energy(const Context& context) {
  const double end_s = context.effort == Effort::kQuick ? 1.0 : 10.0;
  Section section;
  section.title = "Energy that nothing takes away";
  section.markdown = fmt::format(
      "{:g} s in steps of 10 µs: a slide thrown up at 50 m/s, and a mass on a spring without damping. "
      "Largest "
      "change of the\nenergy over its first value, and distance from the closed form at the end. A "
      "fourth-order method damps a spring by\n(w h)^6 / 72 of its energy a step: at 1 kHz that is as if it "
      "had 7e-9 of critical damping, a millionth of what\nany transmission has.\n\n",
      end_s);
  std::vector<std::vector<std::string>> rows;
  for (const auto fidelity : {twin::Fidelity::kReference, twin::Fidelity::kFast}) {
    const std::string name = nameOf(fidelity);
    constexpr double kG = 9.80665;
    constexpr double kUp_m_s = 50.0;
    const Drift thrown = driftOf(
        thrownUp(kUp_m_s), fidelity, end_s,
        [](double z, double v) { return kMass_kg * (0.5 * v * v + kG * z); },
        [](double t) { return kUp_m_s * t - 0.5 * kG * t * t; });
    rows.push_back({"thrown up", name, figureText(thrown.worst, 1e-9), figureText(1e6 * thrown.off_m, 1e-3)});
    section.atMost("thrown up, " + name + ": change of energy", thrown.worst, 1e-9, "", 1e-9);
    for (const double hz : {20.0, 196.0, 1000.0}) {
      const double w = 2.0 * std::numbers::pi * hz;
      constexpr double kSpeed_m_s = 1.0;
      const Drift swung = driftOf(
          massOnSpring(hz, kSpeed_m_s), fidelity, end_s,
          [w](double x, double v) { return 0.5 * kMass_kg * (v * v + w * w * x * x); },
          [w](double t) { return kSpeed_m_s / w * std::sin(w * t); });
      rows.push_back({fmt::format("spring, {:g} Hz", hz), name, figureText(swung.worst, 1e-9),
                      figureText(1e6 * swung.off_m, 1e-3)});
      if (hz == 196.0)
        section.atMost("spring of 196 Hz, " + name + ": change of energy", swung.worst, 1e-6, "", 1e-9);
      if (hz == 1000.0)
        section.atMost("spring of 1 kHz, " + name + ": change of energy", swung.worst, 1e-3, "", 1e-9);
    }
  }
  section.markdown += markdownTable({"", "solver", "change of energy", "from the closed form, µm"}, rows);
  return section;
}

}  // namespace kerfbench::validation
