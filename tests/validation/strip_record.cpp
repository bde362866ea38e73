// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/strip_record.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "hil/machine_file/machine_file.h"

namespace kerfbench::validation {
namespace {

constexpr const char* kHeader = "regime,pieces,cut_s,worst_mm,unlit_mm,peak_kib";

long peakMemory_kib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

}  // namespace

const char* nameOf(StripJob::Regime regime) {
  return regime == StripJob::Regime::kContinuous ? "continuous" : "stop-and-go";
}

twin::MachineDescription stripMachine(const std::filesystem::path& source_dir) {
  twin::MachineDescription machine =
      machine_file::readMachine(source_dir / "fixtures" / "machines" / "strip-gantry.yaml");
  twin::AxisDescription& feed = machine.belt.feed;
  feed = {};
  feed.profile = machine.gantry_x.profile;
  twin::ServoDescription servo;
  servo.natural_frequency_rad_s = 2.0 * std::numbers::pi * 15.0;
  servo.damping = 1.0;
  servo.velocity_feedforward = 1.0;
  feed.drive = servo;
  feed.step = 0.0125;
  feed.load_per_motor = 0.1;
  feed.motor_inertia_kg_m2 = 4e-4;
  // The coupling has 150 Hz between motor and roller, 2 % of critical.
  const double motor_kg_m2 = feed.motor_inertia_kg_m2 / (feed.load_per_motor * feed.load_per_motor);
  const double roller_kg_m2 = machine.belt.roller_inertia_kg_m2;
  const double both_kg_m2 = motor_kg_m2 * roller_kg_m2 / (motor_kg_m2 + roller_kg_m2);
  const double resonance_rad_s = 2.0 * std::numbers::pi * 150.0;
  feed.stiffness = both_kg_m2 * resonance_rad_s * resonance_rad_s;
  feed.stiffness_damping = 2.0 * 0.02 * both_kg_m2 * resonance_rad_s;
  return machine;
}

std::vector<StripFigure> cutPieces(const twin::MachineDescription& machine, const StripJob& job,
                                   twin::Fidelity fidelity, const std::vector<int>& pieces,
                                   const std::function<void(const StripFigure&)>& each) {
  StripLine line(machine, job, fidelity);
  std::vector<StripFigure> figures;
  StripFigure figure{job.regime, 0, 0.0, 0.0, 0.0, 0};
  for (const int goal : pieces) {
    while (figure.pieces < goal) {
      const CutPiece piece = line.nextPiece();
      ++figure.pieces;
      figure.cut_s = piece.cut_s;
      figure.worst_mm = std::max(figure.worst_mm, piece.worst_mm);
      figure.unlit_mm = std::max(figure.unlit_mm, piece.unlit_mm);
    }
    figure.peak_kib = peakMemory_kib();
    figures.push_back(figure);
    if (each) each(figure);
  }
  return figures;
}

std::vector<StripFigure> readFigures(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || line != kHeader) {
    throw std::runtime_error(path.string() + ": not a file of strip figures");
  }
  std::vector<StripFigure> figures;
  while (std::getline(file, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    std::string regime;
    StripFigure figure;
    if (!(words >> regime >> figure.pieces >> figure.cut_s >> figure.worst_mm >> figure.unlit_mm >>
          figure.peak_kib) ||
        (regime != "continuous" && regime != "stop-and-go")) {
      throw std::runtime_error(fmt::format("{}: line {} is no figure", path.string(), figures.size() + 2));
    }
    figure.regime = regime == "continuous" ? StripJob::Regime::kContinuous : StripJob::Regime::kStopAndGo;
    figures.push_back(figure);
  }
  return figures;
}

void writeFigures(const std::filesystem::path& path, const std::vector<StripFigure>& figures) {
  std::string text = std::string(kHeader) + "\n";
  for (const StripFigure& figure : figures) {
    text += fmt::format("{},{},{:.5f},{:.5f},{:.5f},{}\n", nameOf(figure.regime), figure.pieces, figure.cut_s,
                        figure.worst_mm, figure.unlit_mm, figure.peak_kib);
  }
  std::ofstream file(path, std::ios::binary);
  if (!(file << text).flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace kerfbench::validation
