// SPDX-License-Identifier: Apache-2.0
// A strip that is cut while it runs (Hu, Hu, Jiang 2014): errors of known size, seen by the spot camera,
// distinguished from zero and from each other. Figures are compared with their own uncertainty, U = 2 sigma.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double kBelt_mm_s = 200.0;
/// Step of the gantry along x: the controller rounds what it adds for the belt to whole steps, so any
/// constant offset is one of these at most, and always the same within a cut.
constexpr double kStep_mm = 0.0125;

struct Figure {
  double value{}, U{};
};

class StripStillness : public testing::Test {
 protected:
  /// Runs on the native build and the fast twin.
  nlohmann::json run(const std::string& scenario, int exit_code, const std::string& more = "") const {
    const auto path = scratch_.path() / "strip.yaml";
    std::ofstream(path) << "extends: " << fixture("scenarios/" + scenario).string()
                        << "\nname: strip\nprint: {units: " << pieces_ << "}\n"
                        << more;
    const auto result = kerfbench(fmt::format("run '{}' --twin fast --no-pictures --results-dir '{}'",
                                              path.string(), scratch_.path().string()));
    EXPECT_EQ(result.exit_code, exit_code) << result.output;
    return verdictOf(scratch_.path() / "strip");
  }
  static const nlohmann::json& cut(const nlohmann::json& verdict, std::size_t i) {
    return verdict.at("cuts").at("list").at(i);
  }
  static Figure figure(const nlohmann::json& cut, const std::string& name, const std::string& sigma) {
    return {cut.at(name).get<double>(), 2.0 * cut.at(sigma).get<double>()};
  }
  static Figure drift(const nlohmann::json& cut) { return figure(cut, "drift_mm", "drift_sigma_mm"); }
  static Figure offset(const nlohmann::json& cut) { return figure(cut, "offset_mm", "offset_sigma_mm"); }
  static double length_s(const nlohmann::json& cut) {
    return cut.at("end_s").get<double>() - cut.at("start_s").get<double>();
  }
  static void print(const char* what, const nlohmann::json& verdict) {
    for (const auto& c : verdict.at("cuts").at("list")) {
      std::printf("  %s: drift %+.2f +- %.2f um in %.2f s, offset %+.2f +- %.2f um, astray %.1f +- %.1f um\n",
                  what, 1e3 * drift(c).value, 1e3 * drift(c).U, length_s(c), 1e3 * offset(c).value,
                  1e3 * offset(c).U, 1e3 * c.at("excursion_mm").get<double>(),
                  1e3 * c.at("excursion_U_mm").get<double>());
    }
  }
  /// Number of pieces: one alone, or two, for which the head goes forth and back.
  std::size_t pieces_{1};
  ScratchFolder scratch_;

  void expectZeroAndAnOffset() const;
  void expectADriftOfAScale() const;
  void expectABow() const;
};

class StripStillnessLong : public StripStillness {
 protected:
  StripStillnessLong() { pieces_ = 2; }
};

// Expects a drift of zero within its uncertainty. The constant offset of a flawless run is real: the kerf
// camera, which shares nothing with the spot camera, sees the same.
void StripStillness::expectZeroAndAnOffset() const {
  const auto good = run("native/strip-crosscut.yaml", 0);
  print("flawless", good);
  const auto late = run("strip-belt-late.yaml", 0);
  print("100 us late", late);
  const double lag_mm = -kBelt_mm_s * 100e-6;
  for (std::size_t i = 0; i < pieces_; ++i) {
    const Figure drift_good = drift(cut(good, i));
    EXPECT_LT(std::abs(drift_good.value), drift_good.U);
    EXPECT_LT(drift_good.U, 0.005);
    EXPECT_NEAR(std::abs(offset(cut(good, i)).value), good.at("entities")[i].at("rms_mm").get<double>(),
                offset(cut(good, i)).U + good.at("entities")[i].at("rms_U_mm").get<double>());

    const Figure seen = offset(cut(late, i));
    EXPECT_GT(std::abs(seen.value), seen.U) << "told from zero";
    EXPECT_NEAR(seen.value, lag_mm, kStep_mm + seen.U);
    const Figure before = offset(cut(good, i));
    EXPECT_NEAR(seen.value - before.value, lag_mm, kStep_mm + std::hypot(seen.U, before.U));
    EXPECT_GT(std::abs(seen.value - before.value), std::hypot(seen.U, before.U))
        << "told from a flawless run";
    EXPECT_LT(std::abs(drift(cut(late, i)).value), drift(cut(late, i)).U) << "told from a scale error";
  }
}

// Expects a drift of a scale error. A count of the encoder is 0.1 % more than configured: the assumed travel
// of the belt falls short by 1 - 1 / 1.001 of it, in the cut and on the travel from the print mark to its
// middle.
void StripStillness::expectADriftOfAScale() const {
  const auto verdict = run("faults/strip-encoder-scale.yaml", 1);
  print("0.1 % scale", verdict);
  EXPECT_THAT(checksThat(verdict, "FAIL"), AllOf(Contains("stillness_x"), Contains("path")));
  for (std::size_t i = 0; i < pieces_; ++i) {
    const auto& c = cut(verdict, i);
    const double slope_mm_s = -kBelt_mm_s * (1.0 - 1.0 / 1.001);
    EXPECT_NEAR(c.at("slope_mm_s").get<double>(), slope_mm_s, 2.0 * c.at("slope_sigma_mm_s").get<double>());
    EXPECT_NEAR(drift(c).value, slope_mm_s * length_s(c), drift(c).U);
    EXPECT_GT(std::abs(drift(c).value), 10.0 * drift(c).U) << "told from zero, and so from a latency";
    EXPECT_LT(drift(c).U, 0.01);
  }
}

TEST_F(StripStillness, ABeltOfVaryingSpeedIsFollowedByTheEncoder) {
  const auto verdict = run("native/strip-speed-varies.yaml", 0);
  print("followed", verdict);
  EXPECT_EQ(verdict.at("verdict"), "PASS");
}

// Expects a bow: the strip is up to 1.76 mm ahead of its mean motion, 1.0 s after the cut begins, and even at
// the ends.
void StripStillness::expectABow() const {
  const auto verdict = run("faults/strip-mean-speed.yaml", 1);
  print("mean speed", verdict);
  EXPECT_THAT(checksThat(verdict, "FAIL"),
              AllOf(Contains("stillness_x"), Contains("stillness_peak"), Contains("spot_path")));
  for (std::size_t i = 0; i < pieces_; ++i) {
    const auto& c = cut(verdict, i);
    EXPECT_EQ(c.at("frames").get<int>(), 88 + static_cast<int>(i)) << "also where the spot has left its line";
    // The peaks are about zero: the bow and the constant offset of a flawless run, which is less than a step.
    EXPECT_NEAR(c.at("peak_mm").get<double>(), 1.76 + 0.01, c.at("peak_U_mm").get<double>() + 0.1);
  }
  std::ifstream file(scratch_.path() / "strip" / "latest" / "report.html", std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(page, AllOf(HasSubstr("x of spot and sheet over time, and their difference"),
                          HasSubstr("class='dots sheetdots'"),
                          HasSubstr("stays on a straight line while the sheet")));
}

TEST_F(StripStillness, AFlawlessRunShowsZeroAndA100usLatencyAnOffsetAndNoDrift) { expectZeroAndAnOffset(); }
TEST_F(StripStillnessLong, AFlawlessRunShowsZeroAndA100usLatencyAnOffsetAndNoDrift) {
  expectZeroAndAnOffset();
}
TEST_F(StripStillness, A10thOfAPercentOfEncoderScaleIsADrift) { expectADriftOfAScale(); }
TEST_F(StripStillnessLong, A10thOfAPercentOfEncoderScaleIsADrift) { expectADriftOfAScale(); }
TEST_F(StripStillness, TheMeanSpeedOfABeltOfVaryingSpeedFailsAndThePlotShowsWhy) { expectABow(); }
TEST_F(StripStillnessLong, TheMeanSpeedOfABeltOfVaryingSpeedFailsAndThePlotShowsWhy) { expectABow(); }

/// Runs with machine lines under cameras.spot.
class RefusedRuns : public StripStillness {
 protected:
  nlohmann::json filmed(const std::string& spot_keys, int exit_code) const {
    const auto machine = scratch_.path() / "machine.yaml";
    std::ofstream(machine) << "extends: " << fixture("machines/strip-gantry.yaml").string()
                           << "\ncameras: {spot: {" << spot_keys << "}}\n";
    return run("native/strip-crosscut.yaml", exit_code,
               fmt::format("machine: {}\nplanner: {{faults: {{}}}}\n", machine.string()));
  }
  static std::string problems(const nlohmann::json& verdict) { return verdict.at("problems").dump(); }
};

// Cuts last from frame 46 to 133 and from frame 195 to 283.
TEST_F(RefusedRuns, FramesLostWithinACutMakeARunInvalid) {
  const auto verdict = filmed("link: {lost: [{first: 60, count: 2}]}", 3);
  EXPECT_EQ(verdict.at("verdict"), "INVALID");
  EXPECT_EQ(verdict.at("frames").at("lost"), 2);
  EXPECT_THAT(problems(verdict), HasSubstr("lost 2 frames around cuts, the first is number 60"));
}

TEST_F(RefusedRuns, FramesLostBetweenCutsAreToldAndDoNoHarm) {
  pieces_ = 2;
  const auto verdict = filmed("link: {lost: [{first: 150, count: 20}]}", 0);
  EXPECT_EQ(verdict.at("verdict"), "PASS");
  EXPECT_EQ(verdict.at("frames").at("lost"), 20);
  EXPECT_THAT(verdict.dump(), HasSubstr("20 frames were lost between cuts"));
}

TEST_F(RefusedRuns, LateFramesMakeARunInvalid) {
  const auto verdict = filmed("link: {late_ms: 15, late: [{first: 80}]}", 3);
  EXPECT_THAT(problems(verdict),
              AllOf(HasSubstr("the sheet does not lie where the frames before and after have it"),
                    Not(HasSubstr("lost"))));
}

TEST_F(RefusedRuns, DarkFramesMakeARunInvalid) {
  EXPECT_THAT(problems(filmed("board_gray: 3", 3)), HasSubstr("frames of the spot camera are dark"));
}

}  // namespace
}  // namespace kerfbench::test
