// SPDX-License-Identifier: Apache-2.0
// Step of a galvo's servo compared with its closed form.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "tests/validation/studies.h"
#include "tests/validation/support/svg.h"
#include "twin/machine/reference_solver.h"

namespace kerfbench::validation {
namespace {

constexpr double kNatural_hz = 1500.0;
constexpr double kZeta = 0.7;
constexpr double kStep_mm = 20.0;
constexpr double kRadPerMm = 1e-3;  // Mirror angle for a mm of spot 500 mm below: half of 1/500.
constexpr double kEnd_s = 4e-3;

std::shared_ptr<const twin::Mechanism> galvo() {
  twin::MechanismDescription d;
  twin::JointDescription mirror;
  mirror.name = "mirror";
  mirror.mass_kg = 0.01;
  mirror.inertia_kg_m2 = 5e-7;
  d.joints = {mirror};
  twin::ServoDescription servo;
  servo.natural_frequency_rad_s = 2.0 * std::numbers::pi * kNatural_hz;
  servo.damping = kZeta;
  twin::JointDrive drive;
  drive.name = "galvo";
  drive.drive = servo;
  drive.inertia_kg_m2 = mirror.inertia_kg_m2;
  d.drives = {drive};
  return std::make_shared<twin::Mechanism>(std::move(d));
}

// Completed share of the step.
double closedForm(double time_s) {
  const double wn = 2.0 * std::numbers::pi * kNatural_hz;
  const double root = std::sqrt(1.0 - kZeta * kZeta);
  return 1.0 - std::exp(-kZeta * wn * time_s) *
                   (std::cos(wn * root * time_s) + kZeta / root * std::sin(wn * root * time_s));
}

struct Response {
  double worst_um{};
  PlotLine error;
};

Response responseOf(double step_s) {
  twin::ReferenceSolver solver(galvo(), step_s);
  const double command = kStep_mm * kRadPerMm;
  const std::vector<twin::DriveCommand> commands{{command, command, command}};
  Response response;
  response.error.name = fmt::format("{:g} µs", step_s * 1e6);
  const auto steps = std::llround(kEnd_s / step_s);
  for (long long i = 0; i < steps; ++i) {
    solver.step(static_cast<double>(i) * step_s, commands);
    const double time_s = static_cast<double>(i + 1) * step_s;
    const double off_um = 1e3 * std::abs(solver.q()[0] / kRadPerMm - kStep_mm * closedForm(time_s));
    raiseTo(response.worst_um, off_um);
    response.error.points.emplace_back(1e3 * time_s, off_um);
  }
  return response;
}

}  // namespace

Section galvoStep(const Context&) {
  std::vector<std::vector<std::string>> rows;
  LinePlot plot{fmt::format("{:g} mm step: error against the closed form", kStep_mm),
                {"time, ms"},
                {"error, µm", true, 1e-8, 1.0},
                {}};
  std::vector<double> worst;
  for (const double step_us : {5.0, 10.0, 20.0}) {
    const Response response = responseOf(step_us * 1e-6);
    worst.push_back(response.worst_um);
    plot.lines.push_back(response.error);
    rows.push_back({fmt::format("{:g}", step_us), figureText(response.worst_um)});
  }
  Section section;
  section.title = "Step of a galvo against the closed form";
  section.markdown = fmt::format(
      "Servo of {:g} Hz, damping {:g}, a step of {:g} mm of the spot (500 mm below the mirror), reference "
      "solver.\n\n",
      kNatural_hz, kZeta, kStep_mm);
  section.markdown += markdownTable({"solver's step, µs", "largest error, µm"}, rows);
  section.atMost("largest error at 10 µs", worst[1], 1.0, "µm");
  section.atLeast("order of convergence from 20 to 10 µs", std::log2(worst[2] / worst[1]), 3.7, "");
  section.figures.push_back({"galvo-step", plot.title, svgOf(plot)});
  return section;
}

}  // namespace kerfbench::validation
