// SPDX-License-Identifier: Apache-2.0
// Two heads of the proof from pixels, and results that the proof must refuse.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenarios/head_claims.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ProgramRun proven(const char* machine, int seed, const ScratchFolder& scratch) {
  return program("kerfbench-head-pixels",
                 fmt::format("--only {} --first-seed {} --seeds 1 --results-dir '{}'", machine, seed,
                             scratch.path().string()));
}

TEST(HeadPixels, AHeadWithoutALensEndsWithinItsLimitAt400Places) {
  const ScratchFolder scratch;
  const ProgramRun mirrors = proven("two-mirror-300", 3, scratch);
  EXPECT_EQ(mirrors.exit_code, 0) << mirrors.output;
  EXPECT_THAT(mirrors.output, HasSubstr("of 400 within the ellipse"));
  EXPECT_THAT(mirrors.output, HasSubstr("all claims hold"));
}

TEST(HeadPixelsLong, AHeadWithALensEndsWithinItsLimitAt400Places) {
  const ScratchFolder scratch;
  const ProgramRun lens = proven("f-theta", 4, scratch);
  EXPECT_EQ(lens.exit_code, 0) << lens.output;
  EXPECT_THAT(textOf(scratch.path() / "heads.csv"), HasSubstr("f-theta-300-mounted,4,"));
}

CalibratedHead goodHead(std::uint64_t seed) {
  return {.seed = seed,
          .error = "",
          .raw_mm = 3.0,
          .iterations = 1,
          .max_mm = 0.008,
          .rms_mm = 0.003,
          .largest_mm = 0.0085,
          .U_mm = 0.001,
          .places = 400,
          .covered = 380,
          .wall_s = 1.0};
}

std::vector<HeadKindProof> goodProof() {
  HeadKindProof kind{"m", 0.010, {}};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) kind.heads.push_back(goodHead(seed));
  return {kind};
}

TEST(HeadClaims, HoldForTenGoodHeads) { EXPECT_THAT(brokenClaims(goodProof()), IsEmpty()); }

TEST(HeadClaims, NameTheHeadThatIsBeyondItsLimitOrTookTooLongOrHasNoTable) {
  auto proof = goodProof();
  proof[0].heads[2].max_mm = 0.0101;
  proof[0].heads[4].iterations = 4;
  proof[0].heads[7].error = "no marks";
  proof[0].heads[8].U_mm = 0.0016;
  EXPECT_THAT(brokenClaims(proof),
              ElementsAre(HasSubstr("m, seed 3: off by 10.1 um"), HasSubstr("m, seed 5: 4 iterations"),
                          HasSubstr("m, seed 8: no marks"),
                          HasSubstr("m, seed 9: 8.5 ± 1.6 um anywhere are not proven")));
  EXPECT_THAT(tableOf(proof), HasSubstr(" 6/10"));
}

TEST(HeadClaims, AnEllipseTooLargeOrTooSmallForManyHeadsIsToldAndOneOddHeadIsNot) {
  auto proof = goodProof();
  for (CalibratedHead& head : proof[0].heads) head.covered = 400;
  EXPECT_THAT(brokenClaims(proof),
              ElementsAre(HasSubstr("holds 100.0 ± 0.0 % of the places of 10 heads of 10 seeds")));
  for (CalibratedHead& head : proof[0].heads) head.covered = 370;
  EXPECT_THAT(brokenClaims(proof), ElementsAre(HasSubstr("holds 92.5 ± 0.0 %")));
  proof = goodProof();
  proof[0].heads[0].covered = 300;  // Places of one head err together.
  EXPECT_THAT(brokenClaims(proof), IsEmpty());
  EXPECT_NEAR(coverOf(proof[0].heads).share, 0.93, 1e-12);
  EXPECT_NEAR(coverOf(proof[0].heads).sigma, 0.02, 1e-12);  // Spread 0.2 / sqrt(10), over sqrt(10) heads.
  proof[0].heads.resize(9);
  for (CalibratedHead& head : proof[0].heads) head.covered = 400;
  EXPECT_THAT(brokenClaims(proof), IsEmpty());  // The seeds are too few.

  // A share that is too large after one iteration and too small after two is not right on average.
  proof = goodProof();
  proof.push_back(goodProof()[0]);
  for (CalibratedHead& head : proof[0].heads) head.covered = 400;
  for (CalibratedHead& head : proof[1].heads) {
    head.covered = 360;
    head.iterations = 2;
  }
  EXPECT_THAT(brokenClaims(proof),
              ElementsAre(HasSubstr("after 1 iteration the"), HasSubstr("after 2 iterations")));
}

TEST(HeadClaims, HeadsOfOneSeedOnSeveralMachinesAreNoMoreProofThanOne) {
  auto one = goodProof()[0].heads;
  one[0].covered = 300;
  std::vector<CalibratedHead> four;
  for (int machine = 0; machine < 4; ++machine) four.insert(four.end(), one.begin(), one.end());
  EXPECT_NEAR(coverOf(four).share, coverOf(one).share, 1e-12);
  EXPECT_NEAR(coverOf(four).sigma, coverOf(one).sigma, 1e-12);
  EXPECT_EQ(coverOf(four).seeds, 10U);

  // Nine seeds are too few, on any number of machines.
  auto proof = goodProof();
  proof[0].heads.resize(9);
  for (CalibratedHead& head : proof[0].heads) head.covered = 400;
  proof.push_back(proof[0]);
  EXPECT_THAT(brokenClaims(proof), IsEmpty());
}

}  // namespace
}  // namespace kerfbench::test
