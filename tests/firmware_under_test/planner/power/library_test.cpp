// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/library.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libraries.h"

namespace kerfbench::planner {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string textOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Refusal of a text that is written to a file of its own and read; empty: it is accepted.
class Refusal {
 public:
  explicit Refusal(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("planner-power-" + std::to_string(::getpid()) + "-" + name)) {}
  ~Refusal() { std::filesystem::remove(path_); }
  Refusal(const Refusal&) = delete;
  Refusal& operator=(const Refusal&) = delete;
  std::string ofMaterial(const std::string& text) const {
    return of(text, [&] { (void)readMaterial(path_); });
  }
  std::string ofLaser(const std::string& text) const {
    return of(text, [&] { (void)readLaser(path_); });
  }

 private:
  std::string of(const std::string& text, const std::function<void()>& read) const {
    std::ofstream(path_, std::ios::binary) << text;
    try {
      read();
    } catch (const PowerError& error) {
      return error.what();
    }
    return {};
  }
  std::filesystem::path path_;
};

const char* const kHead = "version: 1\nkind: material\nname: m\nunits: {power_per_area: J/mm2, depth: mm}\n";

std::string points(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string text = "points:\n";
  for (const auto& [x, y] : rows)
    text.append("  - {power_per_area: ").append(x).append(", depth: ").append(y).append("}\n");
  return text;
}

TEST(PowerLibrary, TheFixturesHaveThePapersNumbersOfPoints) {
  EXPECT_EQ(test::steel().depth.points().size(), 8U);
  EXPECT_EQ(test::steel().depth.greatest().x, 15.0);
  EXPECT_EQ(test::tube().power.points().size(), 9U);
  EXPECT_EQ(test::tube().power.greatest().y, 80.0);
  EXPECT_EQ(test::tube().control_unit, "%");
}

TEST(PowerLibrary, ThePowerLimitsAreTheCurvesEndsUnlessTold) {
  std::string text = textOf(test::kPowerFolder + "co2-tube-80w.yaml");
  for (const char* key : {"least_power_w", "most_power_w"})
    text.erase(text.find(key), text.find('\n', text.find(key)) - text.find(key));
  const auto path =
      std::filesystem::temp_directory_path() / ("planner-power-ends-" + std::to_string(::getpid()));
  std::ofstream(path) << text;
  const LaserTube tube = readLaser(path);
  std::filesystem::remove(path);
  EXPECT_EQ(tube.least_w, 3.0);
  EXPECT_EQ(tube.most_w, 80.0);
}

TEST(PowerLibrary, NamesEverythingThatIsWrongWithItsLine) {
  const Refusal refusal("all");
  const std::string all = refusal.ofMaterial(
      "version: 2\n"                                // 1
      "kind: laser\n"                               // 2
      "name: \"\\e[2J\"\n"                          // 3
      "units: {depth: inch}\n"                      // 4
      "colour: red\n"                               // 5
      "points:\n"                                   // 6
      "  - {power_per_area: 0, depth: 0.1}\n"       // 7
      "  - {power_per_area: .nan, depth: 0.2}\n"    // 8
      "  - {power_per_area: 2, depth: 0.3}\n"       // 9
      "  - {power_per_area: 2, depth: 0.3}\n"       // 10
      "  - {power_per_area: 1e308, depth: 0.25}\n"  // 11
      "  - {power_per_area: 1e309, depth: -1}\n"    // 12
      "  - {depth: 0.5, width: 3}\n");              // 13
  for (const char* fault :
       {":1: version: this program reads version 1", ":2: kind: 'laser' is none of: material",
        ":3: name: has a control character", ":4: units.power_per_area: missing",
        ":4: units.depth: 'inch' is none of: mm", ":5: colour: unknown key",
        ":6: points: the first must be where cutting begins, at depth 0",
        ":8: points[1].power_per_area: '.nan' is not a number",
        ":10: points[3].power_per_area: 2 does not rise above 2", ":10: points[3].depth: 0.3 does not rise",
        ":11: points[4].power_per_area: 1e+308 is outside 0",
        ":11: points[4].depth: 0.25 does not rise above 0.3",
        ":12: points[5].power_per_area: '1e309' is not a number", ":12: points[5].depth: -1 is outside 0",
        ":13: points[6].power_per_area: missing", ":13: points[6].width: unknown key"}) {
    EXPECT_THAT(all, HasSubstr(fault));
  }
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n') + 1, 16) << all;
  EXPECT_THAT(all, Not(HasSubstr("\x1b")));
}

TEST(PowerLibrary, RefusesLasersThatContradictThemselves) {
  const Refusal refusal("laser");
  const std::string text = textOf(test::kPowerFolder + "co2-tube-80w.yaml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return refusal.ofLaser(changed.replace(at, from.size(), to));
  };
  EXPECT_EQ(with("kind", "kind"), "");
  EXPECT_THAT(with("least_power_w: 4 ", "least_power_w: 2 "),
              HasSubstr(":12: least_power_w: 2 W is outside the curve's 3 … 80 W"));
  EXPECT_THAT(with("most_power_w: 78", "most_power_w: 81"), HasSubstr(":13: most_power_w: 81 W is outside"));
  EXPECT_THAT(with("most_power_w: 78", "most_power_w: 4"),
              HasSubstr(":13: most_power_w: must be above least_power_w"));
  EXPECT_THAT(with("full_control: 100", "full_control: 90"),
              HasSubstr(":11: full_control: 90 is below the curve's last point, 100"));
  EXPECT_THAT(with("full_control: 100", "full_control: .inf"),
              HasSubstr(":11: full_control: '.inf' is not a number"));
  EXPECT_THAT(with("control: \"%\", ", ""), HasSubstr("units.control: missing"));
  EXPECT_THAT(with("power: W", "power: kW"), HasSubstr("units.power: 'kW' is none of: W"));
  EXPECT_THAT(with("control: 40, power: 41", "control: 40, power: 29"),
              HasSubstr(":19: points[3].power: 29 does not rise above 29"));
  EXPECT_THAT(with("control: 40, power: 41", "control: 25, power: 41"),
              HasSubstr(":19: points[3].control: 25 does not rise above 30"));
}

TEST(PowerLibrary, RefusesTooFewOrTooManyPointsAndWhatIsNoList) {
  const Refusal refusal("count");
  EXPECT_THAT(refusal.ofMaterial(std::string(kHead)), HasSubstr("points: 0 of them; a curve has 2 to 1000"));
  EXPECT_THAT(refusal.ofMaterial(kHead + points({{"0", "0"}})), HasSubstr(":5: points: 1 of them"));
  EXPECT_EQ(refusal.ofMaterial(kHead + points({{"0", "0"}, {"1", "1"}})), "");
  EXPECT_THAT(refusal.ofMaterial(std::string(kHead) + "points: 7\n"),
              HasSubstr(":5: points: expected a list"));
  EXPECT_THAT(refusal.ofMaterial(std::string(kHead) + "points: [1, 2, 3]\n"),
              HasSubstr("element 0 is not 'key: value'"));
  std::vector<std::pair<std::string, std::string>> many;
  for (int i = 0; i < 1001; ++i) many.emplace_back(std::to_string(i), std::to_string(i));
  EXPECT_THAT(refusal.ofMaterial(kHead + points(many)), HasSubstr("points: 1001 of them"));
}

TEST(PowerLibrary, RefusesFilesThatAreNone) {
  const Refusal refusal("none");
  for (const char* text : {"", "- 1\n", "name: [\n", "\x01\xff\xfe", "a: &a {b: *a}\n", "? {x: 1}\n: 2\n"}) {
    EXPECT_NE(refusal.ofMaterial(text), "") << text;
    EXPECT_NE(refusal.ofLaser(text), "") << text;
  }
  EXPECT_THROW((void)readLaser("/nowhere/laser.yaml"), PowerError);
}

TEST(PowerLibrary, WhateverIsDamagedIsRefusedOrStillRises) {
  const std::string whole = textOf(test::kPowerFolder + "co2-tube-80w.yaml");
  const std::string text = whole.substr(whole.find("version"));
  const auto path =
      std::filesystem::temp_directory_path() / ("planner-power-damaged-" + std::to_string(::getpid()));
  std::mt19937_64 random(31);
  constexpr char kBytes[] = "0123456789.-+eE:,{}[]&*!?|>'\\\"#%@ \n\t\0\xff~naif";
  const Material steel = test::steel();
  int refused = 0;
  for (int i = 0; i < 600; ++i) {
    std::string damaged = text;
    const int count = std::uniform_int_distribution<int>(1, 4)(random);
    for (int k = 0; k < count; ++k) {
      const std::size_t at = std::uniform_int_distribution<std::size_t>(0, damaged.size() - 1)(random);
      const char byte = kBytes[std::uniform_int_distribution<std::size_t>(0, sizeof kBytes - 2)(random)];
      const auto way = std::uniform_int_distribution<int>(0, 2)(random);
      if (way == 0) damaged[at] = byte;
      if (way == 1) damaged.insert(at, 1, byte);
      if (way == 2) damaged.erase(at, 3);
    }
    std::ofstream(path, std::ios::binary) << damaged;
    try {
      const LaserTube tube = readLaser(path);
      const PowerModel model(steel, tube, {0.2, 0.2, std::nullopt});
      for (std::size_t k = 1; k < tube.power.points().size(); ++k) {
        ASSERT_GT(tube.power.points()[k].x, tube.power.points()[k - 1].x) << damaged;
        ASSERT_GT(tube.power.points()[k].y, tube.power.points()[k - 1].y) << damaged;
      }
      const double power_w = model.at(model.speedsFor(0.2).highest_mm_s, 0.2).power_w;
      ASSERT_TRUE(power_w >= tube.least_w && power_w <= tube.most_w) << damaged;
    } catch (const PowerError&) {
      ++refused;
    }
  }
  std::filesystem::remove(path);
  EXPECT_GT(refused, 200);
  EXPECT_LT(refused, 590);
}

TEST(PowerLibrary, RefusesNestingThatWouldExhaustTheStack) {
  const Refusal refusal("deep");
  EXPECT_NE(refusal.ofMaterial("points: " + std::string(200'000, '[')), "");
  EXPECT_NE(refusal.ofMaterial(std::string(2'000'000, '#')), "");
}

}  // namespace
}  // namespace kerfbench::planner
