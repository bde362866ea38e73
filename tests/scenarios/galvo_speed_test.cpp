// SPDX-License-Identifier: Apache-2.0
// Controller's core with a time base for digital galvos: 2 m/s on a web at 500 mm/s, at no more than 3 um a
// pulse.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

/// Rate in kHz of the most pulses of any axis within 128 us, from the pins as recorded.
double topRate_kHz(const std::filesystem::path& vcd) {
  constexpr double kWindow_s = 128e-6;
  std::map<std::string, std::deque<double>> recent;
  std::set<std::string> pul;
  std::size_t most = 0;
  double now_s = 0.0;
  std::ifstream file(vcd);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("$timescale")) {
      EXPECT_EQ(line, "$timescale 100 ps $end");
    } else if (line.starts_with("$var wire 1 ") && line.find("_pul $end") != std::string::npos) {
      pul.insert(line.substr(12, line.find(' ', 12) - 12));
    } else if (line.starts_with('#')) {
      now_s = std::stod(line.substr(1)) * 1e-10;
    } else if (line.starts_with('1') && pul.contains(line.substr(1))) {
      auto& times = recent[line.substr(1)];
      times.push_back(now_s);
      while (times.front() <= now_s - kWindow_s) times.pop_front();
      most = std::max(most, times.size());
    }
  }
  return 1e-3 * static_cast<double>(most) / kWindow_s;
}

TEST(GalvoSpeed, TwoMetresASecondOnAFastWebPass) {
  const ScratchFolder scratch;
  const auto path = fixture("scenarios/native/blank-fast.yaml");
  const auto run = kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}' --timing", path.string(),
                                         scratch.path().string()));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  std::printf("%s", run.output.c_str());
  const auto verdict = verdictOf(scratch.path() / "blank-fast");

  double top_mm_s = 0.0, top_U_mm_s = 0.0;
  for (const auto& cut : verdict.at("cuts").at("list")) {
    const auto speed = cut.at("top_speed_mm_s");
    if (!speed.is_number() || speed.get<double>() < top_mm_s) continue;
    top_mm_s = speed;
    top_U_mm_s = cut.at("top_speed_U_mm_s");
  }
  std::printf("highest speed of the spot on the sheet, as seen: %.1f +- %.1f mm/s\n", top_mm_s, top_U_mm_s);
  EXPECT_GE(top_mm_s + top_U_mm_s, 2000.0);
  EXPECT_LE(top_mm_s - top_U_mm_s, 2010.0) << "the planner's own limit";

  const double rate_kHz = topRate_kHz(scratch.path() / "blank-fast" / "latest" / "pins.vcd");
  std::printf("highest pulse rate: %.0f kHz\n", rate_kHz);
  EXPECT_GE(rate_kHz, 2000.0 / 3.0);
}

}  // namespace
}  // namespace kerfbench::test
