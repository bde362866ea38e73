// SPDX-License-Identifier: Apache-2.0
// What the flanks of kerfs tell of light, beam and blur.
#include "hil/vision/kerf/flank_belief.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "tests/hil/vision/kerf_twin.h"

#include "hil/vision/kerf/kerf_outline.h"

namespace kerfbench::vision {
namespace {

constexpr double kOpen = 250.0, kBoard = 30.0;

const FlankKnown kKnown{.growth = {},
                        .law_sigma = 0.8,
                        .begin_sigma = 0.3,
                        .beam_radius_mm = 0.105,
                        .radius_share_sigma = 0.03,
                        .blur = {.px = 0.7, .sigma_px = 0.02}};

/// The flank that a view shows of a kerf with such light in its middle.
SeenFlank shown(const FlankView& view, double top_gray) {
  SeenFlank flank{.query = {.half_width_mm = 0.066,
                            .top_gray = top_gray,
                            .board_gray = kBoard,
                            .open_gray = kOpen,
                            .beam_radius_mm = view.beam_radius_mm,
                            .pixel_mm = 0.03,
                            .lens_px = view.lens_px,
                            .growth = view.growth}};
  const FlankFall fall = fallOf(flank.query);
  flank.low_half_mm = fall.low_mm;
  flank.high_half_mm = fall.high_mm;
  flank.query.half_width_mm = fall.half_mm;
  return flank;
}

SeenFlank cutOf(const FlankView& view) { return shown(view, 0.99 * kOpen); }
SeenFlank creaseOf(const FlankView& view) { return shown(view, 0.6 * kOpen); }

FlankView viewOf(double law, double begin = 0.0) {
  return {.growth = {law, begin}, .beam_radius_mm = 0.105, .lens_px = 0.7};
}

double lawOf(const FlankView& view) { return view.growth.law; }

TEST(FlankBelief, IsWhatWasKnownWhereNothingIsSeen) {
  const FlankBelief belief = beliefOf({}, kKnown);
  const FlankMoments law = belief.momentsOf(lawOf);
  EXPECT_EQ(law.likely, 0.0);
  EXPECT_NEAR(law.sigma, 0.8, 1e-9);
  EXPECT_NEAR(belief.momentsOf([](const FlankView& v) { return v.beam_radius_mm; }).sigma, 0.03 * 0.105,
              1e-4);
}

// With a brighter back light the same grey is a shallower crease.
TEST(FlankBelief, ABackLightThatIsNotKnownLeavesDepthOpen) {
  FlankKnown told = kKnown;
  const auto openOf = [](const FlankView& v) { return v.open; };
  EXPECT_EQ(beliefOf({creaseOf(viewOf(0.0))}, told).momentsOf(openOf).sigma, 0.0);
  told.open_sigma = 0.02;
  const FlankBelief belief = beliefOf({}, told);
  EXPECT_EQ(belief.likely.open, 1.0);
  EXPECT_NEAR(belief.momentsOf(openOf).sigma, 0.02, 1e-4);
  const auto meanOf = [&](const auto& quantity) {
    double mean = 0.0;
    for (const FlankView& view : belief.views) mean += view.weight * quantity(view);
    return mean;
  };
  EXPECT_NEAR(meanOf(openOf), 2.0, 1e-9)
      << "as likely brighter as darker; the views of flanks have it as told";
  const auto lensOf = [](const FlankView& v) { return v.lens_px; };
  EXPECT_NEAR(meanOf(lensOf), 2.0 * lensOf(belief.likely), 1e-3);
  const auto fallBy = [](const FlankView& v) {
    FlankQuery query = creaseOf(viewOf(0.0)).query;
    query.open_gray *= v.open;
    return fallOf(query).half_mm;
  };
  EXPECT_GT(belief.momentsOf(fallBy).sigma, 0.0);
}

TEST(FlankBelief, NoBoardGrowsItsLightByMoreThanASquare) {
  // The law is an exponent about the straight one, within two either way: beyond it flanks are as they would
  // be within.
  FlankKnown open_minded = kKnown;
  open_minded.law_sigma = 6.0;
  open_minded.begin_sigma = 0.01;
  for (const double sign : {-1.0, 1.0}) {
    const FlankView steep = viewOf(sign * 2.45);
    const FlankMoments law = beliefOf({cutOf(steep), creaseOf(steep)}, open_minded).momentsOf(lawOf);
    EXPECT_LE(std::abs(law.likely), 2.0 + 1e-9);
    EXPECT_GT(sign * law.likely, 1.5) << "that way it is seen";
  }
}

/// How far the outline of the crease reaches beyond where the beam stopped.
double reachMm(const FlankView& view, const SeenFlank& crease) {
  const FlankQuery& q = crease.query;
  return KerfOutline({.half_width_mm = q.half_width_mm,
                      .brightness = (q.top_gray - q.board_gray) / (q.open_gray - q.board_gray),
                      .board_gray = q.board_gray,
                      .open_gray = q.open_gray,
                      .beam_radius_mm = view.beam_radius_mm,
                      .pixel_mm = q.pixel_mm,
                      .lens_px = view.lens_px,
                      .growth = view.growth})
      .reachMm(0.03);
}

TEST(FlankBelief, HowWideACreaseIsTellsWhereItEnds) {
  for (const double law : {-1.0, 0.0, 1.0}) {
    const FlankView truth = viewOf(law);
    const SeenFlank crease = creaseOf(truth);
    const auto reach = [&](const FlankView& view) { return reachMm(view, crease); };
    std::vector<SeenFlank> flanks(5, cutOf(truth));
    const FlankMoments by_cuts = beliefOf(flanks, kKnown).momentsOf(reach);
    flanks.push_back(crease);
    const FlankMoments by_all = beliefOf(flanks, kKnown).momentsOf(reach);
    EXPECT_LT(by_all.sigma, 0.9 * by_cuts.sigma) << law;
    EXPECT_LT(std::abs(by_all.likely - reach(truth)), 2.0 * by_all.sigma) << law;
  }
}

TEST(FlankBelief, WidthsOfCutsTellNothingOfTheirEnergy) {
  // The same beam at another energy: another width, and the same belief.
  const FlankView truth = viewOf(-0.5);
  SeenFlank wide = cutOf(truth);
  wide.query.half_width_mm = 0.09;
  const FlankFall fall = fallOf(wide.query);
  wide.low_half_mm = fall.low_mm;
  wide.high_half_mm = fall.high_mm;
  const FlankMoments narrow_law = beliefOf({cutOf(truth)}, kKnown).momentsOf(lawOf);
  const FlankMoments wide_law = beliefOf({wide}, kKnown).momentsOf(lawOf);
  EXPECT_NEAR(wide_law.likely, narrow_law.likely, narrow_law.sigma);
}

TEST(FlankBelief, TakesInThatWallsAreUpright) {
  // Flanks of a slit of 130 um with upright walls, as seen in a picture of tests/witness.
  const SeenFlank hard{.query = {.half_width_mm = 0.06518,
                                 .top_gray = 233.2,
                                 .board_gray = 28.0,
                                 .open_gray = 235.0,
                                 .beam_radius_mm = 0.105,
                                 .pixel_mm = 0.03},
                       .low_half_mm = 0.08568,
                       .high_half_mm = 0.04478};
  const KerfScanOptions usual;
  const FlankKnown known{.growth = usual.growth,
                         .law_sigma = usual.law_sigma,
                         .begin_sigma = usual.begin_sigma,
                         .beam_radius_mm = 0.105,
                         .radius_share_sigma = 0.03,
                         .blur = {.px = 0.7024, .sigma_px = 0.0082}};
  FlankQuery query = hard.query;
  const FlankMoments widening =
      beliefOf(std::vector<SeenFlank>(37, hard), known).momentsOf([&](const FlankView& view) {
        query.growth = view.growth;
        query.beam_radius_mm = view.beam_radius_mm;
        query.lens_px = view.lens_px;
        return FlankModel(query).widening_mm();
      });
  RecordProperty("likely_um", std::to_string(1e3 * widening.likely));
  RecordProperty("sigma_um", std::to_string(1e3 * widening.sigma));
  // Seen 0.36 um wider than it is.
  EXPECT_LT(std::abs(widening.likely - 0.36e-3), 2.0 * widening.sigma);
}

TEST(FlankBelief, IsLessSureWhereFlanksDoNotFitItsModel) {
  SeenFlank odd = cutOf(viewOf(0.0));
  const auto lensOf = [](const FlankView& view) { return view.lens_px; };
  const double honest = beliefOf({odd}, kKnown).momentsOf(lensOf).sigma;
  // No view falls over such a way.
  odd.low_half_mm += 0.02;
  odd.high_half_mm -= 0.02;
  EXPECT_GT(beliefOf({odd}, kKnown).momentsOf(lensOf).sigma, 2.0 * honest);
}

TEST(FlankBelief, IsLedByTheCutsOfASheet) {
  // What was known before counts the less: known half as well it does not leave a width half as certain.
  const auto widening_sigma_mm = [](double times) {
    test::TwinCut cut;
    const int line = cut.add(dieline::LineCurve{{-5.0, 0.0}, {5.0, 0.0}});
    cut.options.beam_radius_sigma *= times;
    cut.options.law_sigma *= times;
    cut.options.begin_sigma *= times;
    return test::entityOf(cut.scan(), line).widening_sigma_mm;
  };
  EXPECT_LT(widening_sigma_mm(2.0), 1.5 * widening_sigma_mm(1.0));
}

}  // namespace
}  // namespace kerfbench::vision
