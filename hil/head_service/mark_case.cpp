// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/mark_case.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "hil/head_service/head_setup.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::head_service {
namespace {

constexpr double kCutFluence_j_mm2 = 0.5;
constexpr double kOverCut =
    2.0;  // fluence in the middle of a line over what cuts through: ticks are short, corners oblique

}  // namespace

std::string markScenario(const calibrate::MarkJob& job, const std::filesystem::path& dieline,
                         const MarkCutting& cutting) {
  if (job.p_SW_mm.y() != 0.0)
    throw std::invalid_argument("marks: a sheet on the belt does not lie aside: p_SW must have y = 0");
  // Peak of a line by a round Gaussian spot: sqrt(2 / pi) E / w in its middle.
  const double energy_j_mm =
      kOverCut * kCutFluence_j_mm2 * cutting.beam_radius_mm * std::sqrt(0.5 * std::numbers::pi);
  std::string text = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "version: 1\n"
      "name: {}\n"
      "title: Marks of a calibration\n"
      "dieline: '{}'\n"
      "machine: '{}'\n"
      "imperfections: {}\n"
      "seed: {}\n"
      "twin: {}\n"
      "board: {{thickness_mm: {}, cut_fluence_j_mm2: {}, transmission: 0.12}}\n"
      "print:\n  units: 1\n  pitch_mm: 2000\n  eye_mark_x_mm: {:.9f}\n  eye_mark_length_mm: 4\n  marks:\n",
      job.name, dieline.string(), cutting.machine.string(), scenario::nameOf(cutting.imperfections),
      cutting.seed, scenario::nameOf(cutting.fidelity), kMarkBoard_mm, kCutFluence_j_mm2, job.p_SW_mm.x());
  for (const RegistrationMark& mark : job.print)
    text += fmt::format("    - {{x_mm: {:.9f}, y_mm: {:.9f}, diameter_mm: {:.9f}}}\n", mark.p_SM_mm.x(),
                        mark.p_SM_mm.y(), mark.diameter_mm);
  return text + fmt::format(
                    "belt: {{speed_mm_s: 0, start_x_mm: {:.9f}}}\n"
                    "firmware: {}\n"
                    "planner:\n"
                    "  mark_speed_mm_s: {}\n"
                    "  jump_speed_mm_s: {}\n"
                    "  acceleration_mm_s2: {}\n"
                    "  order: drawn\n"
                    "  cut_energy_j_per_mm: {:.6f}\n"
                    "checks: {{path_mm: 0.05, stillness_mm: 0.05}}\n"
                    "time_limit_s: 600\n",
                    -job.p_SW_mm.x(), cutting.firmware, cutting.mark_speed_mm_s, cutting.jump_speed_mm_s,
                    cutting.acceleration_mm_s2, energy_j_mm);
}

}  // namespace kerfbench::head_service
