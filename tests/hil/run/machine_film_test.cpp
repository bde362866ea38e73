// SPDX-License-Identifier: Apache-2.0
#include "hil/run/machine_film.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "hil/machine_file/machine_file.h"
#include "tests/hil/base/temp_folder.h"
#include "twin/cutter/twin.h"

namespace kerfbench::run {
namespace {

constexpr TickRate kRate{1, 16'000'000};
constexpr double kSpeed_mm_s = 100.0;

// The mirrors rest; the gate is open from 0.02 to 0.03 s and from 0.04 to 0.07 s while the belt runs: two
// lines of 1 and 3 mm along the belt.
class Film : public testing::Test {
 protected:
  Film() {
    web.print.pitch_mm = 70;
    web.start_x_mm = 20;
    web.belt_speed_mm_s = kSpeed_mm_s;
    twin::Twin twin(machine, web, kRate);
    constexpr Tick kQuantum = 8000;
    const Tick end = kRate.ticksAt(0.1);
    for (Tick now = 0; now < end; now += kQuantum) {
      film.add(twin);
      std::vector<PinEvent> events;
      for (const double time_s : {0.02, 0.03, 0.04, 0.07}) {
        const bool on = time_s == 0.02 || time_s == 0.04;
        const Tick tick = kRate.ticksAt(time_s);
        if (tick > now && tick <= now + kQuantum) events.push_back(gateAndPwm(tick, on));
      }
      twin.advance(now + kQuantum, events);
    }
    film.add(twin);
  }
  // Event on PC2 and PC3 of fixtures/machines/two-mirror.yaml.
  static PinEvent gateAndPwm(Tick tick, bool on) {
    PinEvent event;
    event.tick = tick;
    event.port = 2;
    event.changed = 0x0c;
    event.level = on ? 0x0c : 0;
    return event;
  }
  [[nodiscard]] twin::Scene at(double time_s) const { return film.sceneAt(time_s, machine, web, unit); }

  const twin::MachineDescription machine =
      machine_file::readMachine(base::fixture("machines/two-mirror.yaml"));
  const Eigen::AlignedBox2d unit{Eigen::Vector2d(-60, -20), Eigen::Vector2d(0, 20)};
  twin::WebDescription web;
  MachineFilm film{machine.laser.full_power_w};
};

double lengthOf(const std::vector<Eigen::Vector3d>& path) { return (path.back() - path.front()).norm(); }

TEST_F(Film, KnowsWhatWasBurntByThenAndWhetherTheBeamIsOn) {
  EXPECT_TRUE(at(0.015).burnt.empty());
  EXPECT_FALSE(at(0.015).beam_on);
  EXPECT_TRUE(at(0.025).beam_on);
  EXPECT_FALSE(at(0.035).beam_on);
  ASSERT_EQ(at(0.035).burnt.size(), 1U);
  EXPECT_NEAR(lengthOf(at(0.035).burnt[0]), 1.0, 0.06);
  const twin::Scene end = at(0.1);
  ASSERT_EQ(end.burnt.size(), 2U);
  EXPECT_NEAR(lengthOf(end.burnt[0]), 1.0, 0.06);
  EXPECT_NEAR(lengthOf(end.burnt[1]), 3.0, 0.06);
}

TEST_F(Film, ALineStaysOnTheSheetThatCarriesItAway) {
  const Eigen::Vector3d before = at(0.05).burnt.at(0).front();
  const Eigen::Vector3d after = at(0.09).burnt.at(0).front();
  EXPECT_NEAR((after - before).x(), 0.04 * kSpeed_mm_s, 1e-3);
  // The place lay under the resting beam while it was burnt.
  const Eigen::Vector3d fresh = at(0.06).burnt.at(1).back();
  EXPECT_NEAR(fresh.x(), 0.0, 1e-6);
  EXPECT_NEAR(fresh.y(), 0.0, 1e-6);
}

TEST_F(Film, FindsTheMiddleOfTheLongestCut) { EXPECT_NEAR(film.middleOfLongestCut_s(), 0.055, 0.0006); }

TEST_F(Film, ATimeBeyondTheEndIsTheEnd) {
  EXPECT_NEAR(film.end_s(), 0.1, 1e-9);
  EXPECT_EQ(at(50.0).time_s, at(film.end_s()).time_s);
}

TEST_F(Film, TheFinishedSheetLiesUnderTheHead) {
  const twin::Scene scene = film.finishedSheet(machine, web, unit);
  EXPECT_FALSE(scene.beam_on);
  ASSERT_EQ(scene.burnt.size(), 2U);
  Eigen::AlignedBox3d burnt;
  for (const auto& path : scene.burnt) {
    for (const Eigen::Vector3d& p : path) burnt.extend(p);
  }
  EXPECT_NEAR(burnt.center().x(), 0.0, 1e-9);
}

TEST(EmptyFilm, HasNothingToShow) {
  const MachineFilm film(100.0);
  EXPECT_TRUE(film.empty());
  EXPECT_THROW((void)film.sceneAt(0.0, {}, {}, {}), std::logic_error);
}

}  // namespace
}  // namespace kerfbench::run
