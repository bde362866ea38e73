// SPDX-License-Identifier: Apache-2.0
// In the guest: a release as a controller board on a simulated chip, and the bench live before it – reads its
// pins, drives its encoder, print mark and interlock, talks to it on its terminal, and gives its verdict.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include "tests/guest/player.h"
#include "tests/guest/sim_chip.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(Live, Good) {
  SimChip chip("kerfbench-live", {"X_PUL", "X_DIR", "Y_PUL", "Y_DIR", "GATE", "PWM", "ENC_A", "ENC_B", "MARK", "DOOR"});
  for (const auto& e : fs::directory_iterator("/sys/devices/platform")) fmt::print("{}\n", e.path().string());
}

}  // namespace
}  // namespace kerfbench::guest
