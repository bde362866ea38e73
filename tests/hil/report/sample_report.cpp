// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/report/sample_report.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include <Eigen/Geometry>

#include "hil/dieline/geometry.h"
#include "twin/base/image.h"

namespace kerfbench::report::test {
namespace {

/// A kerf as the camera might show it, bent by `offset_mm` to one side.
vision::KerfPatch patchAt(int unit, int entity, const Eigen::Vector2d& p_S_mm, double offset_mm) {
  const auto image = std::make_shared<GrayImage>(48, 48, 38);
  vision::KerfPatch patch{unit, entity, p_S_mm, image, Eigen::Affine2d::Identity()};
  constexpr double kPixel_mm = 0.04;
  for (int row = 0; row < 48; ++row) {
    for (int column = 0; column < 48; ++column) {
      const double across_mm = (column - 23.5) * kPixel_mm + offset_mm;
      const double edge = 1.0 / (1.0 + std::exp((std::abs(across_mm) - 0.105) / 0.012));
      image->at(column, row) = static_cast<std::uint8_t>(38 + 190 * edge + (row * 7 + column * 13) % 9);
    }
  }
  patch.pixel_from_S.linear() << 1.0 / kPixel_mm, 0, 0, -1.0 / kPixel_mm;
  patch.pixel_from_S.translation() = Eigen::Vector2d(23.5, 23.5) - patch.pixel_from_S.linear() * p_S_mm;
  return patch;
}

}  // namespace

RunReport reportOf(const inspect::testing::SyntheticRun& run) {
  RunReport report;
  report.scenario = "carton-on-belt";
  report.scenario_path = "fixtures/scenarios/carton-on-belt.yaml";
  report.scenario_text = "version: 1\nname: carton-on-belt\nbelt: {speed_mm_s: 200}\n";
  report.machine = "two-mirror-160";
  report.firmware = "controller-avr.hex <atmega2560>";
  report.source_id = "avr atmega2560 16 MHz";
  report.repeat_command = "kerfbench run carton-on-belt.yaml --seed 42";
  report.seed = 42;
  report.model.imperfections = "static";
  report.model.twin = "reference";
  report.model.sampled = {{"galvo_x.zero", 4.5e-6, "rad"}, {"belt.roller_radius", -2e-5, "<relative>"}};
  report.virtual_s = 4.25;
  report.versions = {{"kerfbench", "0.1.0"}, {"OpenCV", "4.6.0"}};
  report.limits = run.limits;
  dieline::Dieline drawing = run.dieline;
  drawing.path = "fixtures/dielines/carton.dxf";
  report.dieline = std::make_shared<const dieline::Dieline>(std::move(drawing));
  report.print = run.evidence.print;
  report.kerf = run.evidence.kerf;
  report.spot = run.evidence.spot;
  report.pulses = run.evidence.pulses;
  report.result = run.inspected();
  report.host = "bench-1";
  report.finished = "2024-05-01 12:00";
  report.timing = {{"twin", 3.5}, {"vision", 1.25}};
  report.pictures = {{"sheet-unit0.png", "The finished sheet"}};
  return report;
}

inspect::testing::SyntheticRun badRun() {
  inspect::testing::SyntheticRun run;
  auto& right = run.kerf(1, inspect::testing::kRight).calipers;
  for (std::size_t i = 0; i < right.size(); ++i) {
    if (right[i].found) right[i].offset_mm += 0.075 * std::sin(3.14 * static_cast<double>(i) / 160.0);
  }
  auto& top = run.kerf(0, inspect::testing::kTop).calipers;
  for (std::size_t i = 0; i < top.size(); ++i) {
    if (top[i].found) top[i].offset_mm -= 0.03 * std::sin(0.1 * static_cast<double>(i));
  }
  for (std::size_t i = 60; i < 90; ++i) {
    vision::Caliper& c = run.kerf(1, inspect::testing::kBottom).calipers[i];
    c.found = false;
    c.brightness = 0.0;
    c.offset_mm = c.width_mm = std::nan("");
  }
  run.evidence.kerf.strays.push_back({1, {22, 30}, 2.1});
  run.shiftSpot(1, inspect::testing::kCreaseLine,
                [](double t_s) { return Eigen::Vector2d(t_s / 0.12 * 0.09, 0.0); });
  run.evidence.pulses[1].min_setup_s = 1.1e-6;
  run.evidence.pulses[1].setup_violations = 37;
  run.evidence.pulses[1].first_violation_s = 1.25;
  run.evidence.pulses[1].setup_histogram[2] = 37;
  const auto mosaic = std::make_shared<GrayImage>(64, 44, 40);
  for (int column = 0; column < 64; ++column) mosaic->at(column, 22) = 230;
  run.evidence.kerf.mosaic = {1, mosaic,
                              Eigen::AlignedBox2d(Eigen::Vector2d(-2, -2), Eigen::Vector2d(62, 42))};
  run.evidence.kerf.patches = {patchAt(1, inspect::testing::kRight, {60, 20}, -0.075),
                               patchAt(0, inspect::testing::kTop, {20, 40}, 0.03)};
  return run;
}

}  // namespace kerfbench::report::test
