// SPDX-License-Identifier: Apache-2.0
// A sheet on an accelerating belt against Coulomb's law.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/machine_file/machine_file.h"
#include "tests/validation/studies.h"
#include "tests/validation/support/machine_run.h"
#include "tests/validation/support/rk4.h"
#include "tests/validation/support/solvers.h"
#include "tests/validation/support/svg.h"

namespace kerfbench::validation {
namespace {

constexpr double kG_m_s2 = 9.80665;
constexpr double kStep_s = 10e-6;
constexpr double kMetre_mm = 1e3;
constexpr double kBelt_kg = 0.5, kSheet_kg = 0.05, kMu = 0.6;

// A belt pulled by a constant force, a sheet on it that the belt drags along with `held_n`.
std::shared_ptr<const twin::Mechanism> pulledBelt(double force_n, double held_n) {
  twin::MechanismDescription d;
  const auto slide = [&d](const char* name, int parent, const Eigen::Vector3d& axis, double mass_kg) {
    twin::JointDescription joint;
    joint.name = name;
    joint.kind = twin::JointDescription::Kind::kPrismatic;
    joint.parent = parent;
    joint.axis = axis;
    joint.mass_kg = mass_kg;
    d.joints.push_back(joint);
  };
  slide("belt", -1, Eigen::Vector3d::UnitX(), kBelt_kg);
  slide("sheet x", 0, Eigen::Vector3d::UnitX(), 0.0);
  slide("sheet y", 1, Eigen::Vector3d::UnitY(), kSheet_kg);
  twin::JointFriction grip;
  grip.joint = 1;
  grip.across = 2;
  grip.friction.coulomb = kMu * kSheet_kg * kG_m_s2;
  grip.start_load = -held_n;  // The load is steady from the start: the force has pulled for long.
  d.frictions = {grip};
  d.constant_forces = {{0, force_n}};
  return std::make_shared<twin::Mechanism>(std::move(d));
}

// Slip at `times`, mm, positive where the sheet stays behind.
std::vector<double> slipsAt(double share_of_grip, const std::vector<double>& times_s,
                            twin::Fidelity fidelity) {
  const double limit_m_s2 = kMu * kG_m_s2;
  const double held_n = kSheet_kg * std::min(share_of_grip, 1.0) * limit_m_s2;
  const double force_n = kBelt_kg * share_of_grip * limit_m_s2 + held_n;
  const auto solver = solverOf(pulledBelt(force_n, held_n), kStep_s, fidelity);
  std::vector<double> slips;
  long long n = 0;
  for (const double time_s : times_s) {
    for (; n < std::llround(time_s / kStep_s); ++n) solver->step(static_cast<double>(n) * kStep_s, {});
    slips.push_back(-kMetre_mm * solver->q()[1]);
  }
  return slips;
}

// The sheet by hand on the belt's motion (its place every 10 us): Coulomb's law with nothing else, or with
// the twin's presliding: a spring and a damper of half the critical before the slider, which give before it
// breaks loose. Slip in mm, positive where the sheet stays behind.
double coulombByHand_mm(const std::vector<double>& belt_mm, double limit_mm_s2) {
  double sheet_mm_s = 0.0, slip_mm = 0.0;
  for (std::size_t i = 1; i < belt_mm.size(); ++i) {
    const double speed_mm_s = (belt_mm[i] - belt_mm[i - 1]) / kStep_s;  // Speed in the middle of the step.
    const double most_mm_s = limit_mm_s2 * kStep_s;
    sheet_mm_s += std::clamp(speed_mm_s - sheet_mm_s, -most_mm_s, most_mm_s);
    slip_mm += (speed_mm_s - sheet_mm_s) * kStep_s;
  }
  return slip_mm;
}

double preslidingByHand_mm(const std::vector<double>& belt_mm, const twin::BeltDescription& belt) {
  constexpr int kParts = 10;
  constexpr double kPart_s = kStep_s / kParts;
  constexpr double kPresliding_mm = 1e-3;
  const double limit_mm_s2 = belt.sheet_friction * kG_m_s2 * kMetre_mm;
  const double k = limit_mm_s2 / kPresliding_mm;  // Stiffness over the sheet's mass.
  const double c = std::sqrt(k / (1.0 + belt.sheet_mass_kg / belt.mass_kg));
  const auto speedAt = [&](std::size_t middle) { return (belt_mm[middle + 1] - belt_mm[middle]) / kStep_s; };
  std::array<double, 3> y{};  // State: the sheet's speed, the bristle, the slip.
  for (std::size_t i = 0; i + 2 < belt_mm.size(); ++i) {
    // The means are half a step late, like their sum.
    const double from_mm_s = speedAt(i), to_mm_s = speedAt(i + 1);
    for (int part = 0; part < kParts; ++part) {
      rk4Step(y, part * kPart_s, kPart_s, [&](double time_s, const auto& at, auto& rate) {
        const double over_mm_s = from_mm_s + (to_mm_s - from_mm_s) * time_s / kStep_s - at[0];
        const double wanted = k * at[1] + c * over_mm_s;
        const double given = std::clamp(wanted, -limit_mm_s2, limit_mm_s2);
        rate[0] = given;
        rate[1] = (given - k * at[1]) / c;
        rate[2] = over_mm_s;
      });
    }
  }
  return y[2];
}

// A line that speeds up from rest within 0.1 s, and the motion of the machine's sheet.
struct LineSlip {
  double twin_mm{}, presliding_mm{}, coulomb_mm{}, ideal_mm{};
};

LineSlip lineSlip(const twin::MachineDescription& machine, double share, twin::Fidelity fidelity) {
  constexpr double kBegin_s = 0.05, kRamp_s = 0.1, kEnd_s = 1.2;
  const double limit_mm_s2 = machine.belt.sheet_friction * kG_m_s2 * kMetre_mm;
  twin::WebDescription web = restingWeb();
  web.belt_speed_changes = {{kBegin_s, 0.0}, {kBegin_s + kRamp_s, share * limit_mm_s2 * kRamp_s}};
  twin::MachineModel model(machine, web, fidelity);
  std::vector<double> belt_mm{0.0};
  for (long long i = 0; i < std::llround(kEnd_s / kStep_s); ++i) {
    model.run(static_cast<std::uint64_t>(i), 1);
    belt_mm.push_back(model.pose().belt_travel_mm);
  }
  LineSlip slip;
  slip.twin_mm = -model.pose().sheet_slip_mm.x();
  slip.coulomb_mm = coulombByHand_mm(belt_mm, limit_mm_s2);
  slip.presliding_mm = preslidingByHand_mm(belt_mm, machine.belt);
  if (share > 1.0) slip.ideal_mm = 0.5 * (share - 1.0) * share * limit_mm_s2 * kRamp_s * kRamp_s;
  return slip;
}

std::string slipText(double slip_mm) { return fmt::format("{:.4f}", std::abs(slip_mm)); }

/// Errors of the law alone, with the table of its slips.
struct LawErrors {
  double creep_mm{0.0}, slip_mm{0.0};
  std::string table;
};

LawErrors lawErrors(double hold_s) {
  LawErrors errors;
  std::vector<std::vector<std::string>> rows;
  constexpr double kSlide_s = 0.5;
  for (const auto fidelity : {twin::Fidelity::kReference, twin::Fidelity::kFast}) {
    for (const double share : {0.5, 0.9, 0.999}) {
      const auto slips = slipsAt(share, {0.2, hold_s}, fidelity);
      raiseTo(errors.creep_mm, std::abs(slips[1] - slips[0]));
      rows.push_back({nameOf(fidelity), fmt::format("{:g}", share), fmt::format("{:g}", hold_s),
                      figureText(std::abs(slips[1]), 1e-9), "holds",
                      figureText(std::abs(slips[1] - slips[0]), 1e-9)});
    }
    for (const double share : {1.01, 1.5, 3.0}) {
      const double ideal_mm = 0.5 * (share - 1.0) * kMu * kG_m_s2 * kSlide_s * kSlide_s * kMetre_mm;
      const double found_mm = slipsAt(share, {kSlide_s}, fidelity)[0];
      raiseTo(errors.slip_mm, std::abs(found_mm - ideal_mm));
      rows.push_back({nameOf(fidelity), fmt::format("{:g}", share), fmt::format("{:g}", kSlide_s),
                      fmt::format("{:.5f}", found_mm), fmt::format("{:.5f}", ideal_mm),
                      figureText(std::abs(found_mm - ideal_mm), 1e-9)});
    }
  }
  errors.table = markdownTable(
      {"solver", "a / (mu g)", "time, s", "slip", "closed form", "difference (below 1: creep)"}, rows);
  return errors;
}

/// Slips on the machine's belt, as a table and a plot, with the largest error.
struct LineSlips {
  double error_mm{0.0};
  std::string table;
  LinePlot plot;
};

LineSlips lineSlips(const twin::MachineDescription& machine, bool quick) {
  LineSlips slips;
  std::vector<std::vector<std::string>> rows;
  PlotLine twin_line{"twin", {}, false, true}, ideal_line{"ideal belt", {}, true, false};
  const std::vector<double> shares =
      quick ? std::vector{0.5, 1.5} : std::vector{0.25, 0.5, 0.75, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, 3.0};
  for (const double share : shares) {
    const LineSlip slip = lineSlip(machine, share, twin::Fidelity::kReference);
    raiseTo(slips.error_mm, std::abs(slip.twin_mm - slip.presliding_mm));
    rows.push_back({fmt::format("{:g}", share), slipText(slip.twin_mm), slipText(slip.presliding_mm),
                    slipText(slip.coulomb_mm), fmt::format("{:.4f}", slip.ideal_mm)});
    twin_line.points.emplace_back(share, slip.twin_mm);
    ideal_line.points.emplace_back(share, slip.ideal_mm);
  }
  slips.table = markdownTable(
      {"a / (mu g)", "slip of the twin, mm", "by hand", "without presliding", "ideal belt"}, rows);
  slips.plot = {"Slip of the sheet while the line speeds up",
                {"acceleration over mu g"},
                {"slip, mm"},
                {twin_line, ideal_line}};
  return slips;
}

}  // namespace

Section beltFriction(const Context& context) {
  const bool quick = context.effort == Effort::kQuick;
  const double hold_s = quick ? 1.0 : 10.0;
  Section section;
  section.title = "The sheet on the belt against Coulomb's law";
  section.markdown = fmt::format(
      "First the law alone: a belt that a constant force has pulled for long, a sheet with friction "
      "coefficient "
      "{:g} on it, a / (mu g)\nfrom below to above 1. Below the limit it holds; above it slips by ½ (a - mu "
      "g) "
      "t². Slip in mm.\n\n",
      kMu);
  const LawErrors law = lawErrors(hold_s);
  section.markdown += law.table;

  const auto machine = machine_file::readMachine(context.source_dir / "fixtures/machines/two-mirror.yaml");
  section.markdown += fmt::format(
      "Then the machine of `two-mirror.yaml`: its line speeds up from rest within 0.1 s, mu = {:g}. By hand: "
      "Coulomb's law on\nthe motion that its belt really made, drive and stretch included. Ideal: a belt "
      "that "
      "follows the ramp exactly,\n½ (a - mu g) T² a / (mu g).\n\n",
      machine.belt.sheet_friction);
  const LineSlips line = lineSlips(machine, quick);
  section.markdown += line.table;
  section.atMost("creep of a sheet that holds", law.creep_mm, 1e-6, "mm", 1e-9);
  section.atMost("slip of a sheet that slides, against the closed form", law.slip_mm, 0.005, "mm");
  section.atMost("slip on the machine's belt, against the law by hand", line.error_mm, 0.005, "mm");
  section.figures.push_back({"belt-friction", line.plot.title, svgOf(line.plot)});
  return section;
}

}  // namespace kerfbench::validation
