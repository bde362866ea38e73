// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/inspect.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

TEST(Inspect, AFlawlessRunPassesEveryCheck) {
  SyntheticRun run;
  const auto result = run.inspected();
  for (const Check& check : result.checks) {
    EXPECT_EQ(check.verdict, Verdict::kPass) << check.name << ": " << check.explanation;
    EXPECT_FALSE(check.explanation.empty()) << check.name;
    EXPECT_FALSE(check.title.empty()) << check.name;
  }
  EXPECT_TRUE(result.problems.empty());
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_EQ(result.checks.size(), 19U);
}

TEST(Inspect, EveryKindOfBrokenEvidenceIsInvalid) {
  const SyntheticRun good;
  const auto verdictAfter = [&](auto&& spoil) {
    SyntheticRun run = good;
    spoil(run);
    return run.inspected().verdict;
  };
  EXPECT_EQ(verdictAfter([](SyntheticRun&) {}), Verdict::kPass);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.problems.emplace_back("Gap in the pin stream."); }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.spot.frames_lost = 1; }), Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.spot.frames.clear(); }), Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.kerf.problems.emplace_back("Marks not found."); }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.kerf.entities.clear(); }), Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.kerf.entities.pop_back(); }), Verdict::kInvalid);
  EXPECT_EQ(
      verdictAfter([](SyntheticRun& r) { r.evidence.kerf.entities.erase(r.evidence.kerf.entities.begin()); }),
      Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) {
              r.evidence.spot.frames[40].spot_W_mm->y() = std::numeric_limits<double>::quiet_NaN();
            }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.kerf.entities[1].entity = 99; }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.pulses.clear(); }), Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) {
              r.kerf(0, kTop).calipers[50].offset_mm = std::numeric_limits<double>::quiet_NaN();
            }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) {
              for (auto& frame : r.evidence.spot.frames) frame.sheet.clear();
            }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.spot_calibration.reset(); }), Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.kerf_calibration.reset(); }), Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.kerf(0, kTop).calipers[50].sigma_mm = 0.0; }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.kerf(0, kTop).calipers[50].p_V_mm.x() = 61.0; }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.spot_calibration->area_mm.max().x() = 100.0; }),
            Verdict::kInvalid);
  EXPECT_EQ(verdictAfter([](SyntheticRun& r) { r.evidence.kerf.units.pop_back(); }), Verdict::kInvalid);
}

TEST(Inspect, IsPure) {
  const SyntheticRun run;
  const auto a = run.inspected();
  const auto b = run.inspected();
  ASSERT_EQ(a.checks.size(), b.checks.size());
  for (std::size_t i = 0; i < a.checks.size(); ++i) {
    EXPECT_EQ(a.checks[i].value, b.checks[i].value);
    EXPECT_EQ(a.checks[i].explanation, b.checks[i].explanation);
  }
}

}  // namespace
}  // namespace kerfbench::inspect
