// SPDX-License-Identifier: Apache-2.0
// Short form of the proof; in full: kerfplan prove-compensation, docs/explanation/compensation.md.
#include "firmware_under_test/planner/compensation/proof.h"

#include <gtest/gtest.h>

namespace kerfbench::planner {
namespace {

ProofGrid coarse() {
  ProofGrid grid;
  grid.fold_step_deg = 20.0;
  grid.turn_step_deg = 15.0;
  grid.omegas_deg = {90.0, 150.0, 181.0, 240.0, 270.0, 310.0, 349.9};
  grid.radii_mm = {0.11};
  return grid;
}

TEST(Proof, HoldsOnACoarseGrid) {
  const Proof proof = prove(coarse());
  for (const std::string& corner : proof.unexpected) ADD_FAILURE() << corner;
  EXPECT_EQ(proof.not_refused, 0U);
  EXPECT_GT(proof.refused, 1000U);
  ASSERT_EQ(proof.space.size(), 9U);
  for (const SpaceProofRow& row : proof.space) {
    EXPECT_GT(row.corners, 0U);
    EXPECT_GT(row.nearest, 1.0 - 1e-9) << row.number;
    EXPECT_LT(row.missed, 1e-6) << row.number;
  }
  EXPECT_GE(proof.plane.size(), 12U);
  for (const PlaneProofRow& row : proof.plane) EXPECT_EQ(row.failed, 0U) << row.pair << nameOf(row.kind);
  EXPECT_TRUE(proof.holds());
}

/// The checker must report a known fault: the joints of the paper's text, which protect B alone.
TEST(Proof, SeesThatThePapersJointsComeNearerToTheSecondLine) {
  const Proof proof = prove(coarse());
  for (const SpaceProofRow& row : proof.space) {
    if (row.joint == SpaceJoint::kIntersection) {
      EXPECT_LT(row.paper_nearest, 0.9) << row.number;
    }
    if (row.joint == SpaceJoint::kFixedLength) {
      EXPECT_LT(row.paper_corners, row.corners) << row.number;
    }
  }
}

}  // namespace
}  // namespace kerfbench::planner
