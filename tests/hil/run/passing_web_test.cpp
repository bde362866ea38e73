// SPDX-License-Identifier: Apache-2.0
// A web that is photographed while it passes.
#include <cstddef>
#include <limits>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "hil/camera/kerf_tile.h"
#include "hil/run/model_machine.h"
#include "hil/scenario/case.h"
#include "hil/source/open.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::run {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

class PassingWebOfLabels : public testing::Test {
 protected:
  PassingWebOfLabels()
      : test_case(scenario::readCase(base::fixture("scenarios/native/label-on-belt.yaml"),
                                     images.write("controller-native", "").parent_path())),
        sampled(scenario::sampledMachine(test_case)),
        machine(test_case, sampled, TickRate{}, options()) {}

  static ModelOptions options() {
    ModelOptions options;
    options.fidelity = twin::Fidelity::kFast;
    options.record_exposures = false;
    return options;
  }

  /// The belt runs, and the controller does nothing.
  RecordedRun idle(double time_s) {
    source::PinRecording nothing;
    nothing.end = nothing.rate.ticksAt(time_s);
    LockstepOptions lockstep;
    lockstep.time_limit_s = time_s;
    return machine.run(*source::openRecording(nothing, "nothing"), nullptr, lockstep, {});
  }

  const base::TempFolder images;  // No release is run here.
  scenario::Case test_case;
  twin::SampledMachine sampled;
  ModelMachine machine;
};

TEST_F(PassingWebOfLabels, EachUnitIsPhotographedInTheEnd) {
  const auto tiles = machine.kerfTilesMeanwhile(2, kAll);
  ASSERT_TRUE(tiles);
  EXPECT_TRUE(idle(9.0).problems.empty());
  int units = 0;
  for (auto batch = tiles->nextBatch(1); !batch.empty(); batch = tiles->nextBatch(1)) {
    EXPECT_EQ(batch.front().unit, units);
    if (batch.front().is_last) ++units;
  }
  EXPECT_EQ(units, test_case.scenario.print.units);
}

TEST_F(PassingWebOfLabels, ASheetThatIsTakenAwayIsNotHandedOutWhole) {
  EXPECT_NO_THROW((void)machine.sheet());
  const auto tiles = machine.kerfTilesMeanwhile(1, kAll);
  ASSERT_TRUE(tiles);
  EXPECT_THROW((void)machine.sheet(), std::logic_error);
  EXPECT_THROW((void)machine.kerfTiles(1), std::logic_error);
  EXPECT_THROW((void)machine.kerfTilesMeanwhile(1, kAll), std::logic_error);
}

}  // namespace
}  // namespace kerfbench::run
