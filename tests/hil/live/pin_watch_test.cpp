// SPDX-License-Identifier: Apache-2.0
#include "hil/live/pin_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::live {
namespace {

using Json = nlohmann::json;

class PinWatchTest : public testing::Test {
 protected:
  PinWatchTest() {
    map_.assign(Signal::kGalvoXPul, {0, 0});
    map_.assign(Signal::kLaserGate, {2, 5});
    map_.assign(Signal::kEncoderA, {1, 0});
  }
  /// Events of this name that were told, in their order.
  [[nodiscard]] std::vector<Json> told(const std::string& name) const {
    std::vector<Json> events;
    std::istringstream lines(base::contentOf(path_));
    for (std::string line; std::getline(lines, line);)
      if (const Json event = Json::parse(line); event["event"] == name) events.push_back(event);
    return events;
  }

  base::TempFolder folder_;
  std::filesystem::path path_{folder_.path() / "events"};
  base::EventLog log_{path_};
  SignalMap map_;
  static constexpr TickRate kNs{1, 1'000'000'000};
};

TEST_F(PinWatchTest, CountsTheEdgesOfTheControllersOutputs) {
  {
    PinWatch watch(map_, kNs, &log_);
    watch.heard(100, std::array<PinEvent, 1>{{{1, 2, 0, 0b100000, 0}}});  // Levels at the start.
    std::vector<PinEvent> events;
    for (Tick tick = 1000; tick < 1010; ++tick)
      events.push_back({tick, 0, 1, static_cast<std::uint16_t>(tick & 1U), 0});
    events.push_back({1020, 2, 0b100000, 0, 0});
    events.push_back({1030, 1, 1, 1, 0});  // A sensor is the bench's own.
    watch.heard(2'000'000'000, events);
    watch.lagged(12'300);
  }
  const std::vector<Json> pins = told("pins");
  ASSERT_FALSE(pins.empty());
  EXPECT_EQ(pins.back()["signals"], Json({"galvo_x_pul", "laser_gate"}));
  EXPECT_EQ(pins.back()["edges"], Json({10, 1}));
  EXPECT_EQ(pins.back()["levels"], Json({1, 0}));
  EXPECT_EQ(pins.back()["now_s"], 2.0);
  EXPECT_EQ(pins.back()["worst_lag_us"], 12.3);
  EXPECT_TRUE(told("problem").empty());
}

TEST_F(PinWatchTest, CountsTheEdgesOfLines) {
  const std::vector<source::GpioWire> wires{{Signal::kLaserGate, 7}, {Signal::kGalvoXPul, 3}};
  {
    PinWatch watch(map_, kNs, &log_);
    const std::vector<source::LineEdge> edges{{10, 0, true, true, false},
                                              {20, 1, true, true, false},
                                              {30, 1, false, true, false},
                                              {40, 1, false, false, false}};
    watch.heard(50, edges, wires);
  }
  EXPECT_EQ(told("pins").back()["edges"], Json({2, 1}));
  EXPECT_EQ(told("pins").back()["levels"], Json({0, 1}));
}

TEST_F(PinWatchTest, EdgesThatWereLostAreAProblemOnce) {
  {
    PinWatch watch(map_, kNs, &log_);
    for (Tick tick = 10; tick < 20; ++tick)
      watch.heard(tick, std::array<PinEvent, 1>{{{tick, 0, 0, 0, PinEvent::kGap}}});
  }
  ASSERT_EQ(told("problem").size(), 1U);
  EXPECT_THAT(told("problem")[0]["text"].get<std::string>(), testing::HasSubstr("INVALID"));
}

TEST_F(PinWatchTest, NobodyWatchesWithoutALog) {
  PinWatch watch(map_, kNs, nullptr);
  EXPECT_FALSE(watch.isWatched());
  watch.heard(10, std::array<PinEvent, 1>{{{5, 0, 1, 1, 0}}});
}

}  // namespace
}  // namespace kerfbench::live
