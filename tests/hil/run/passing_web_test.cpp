// SPDX-License-Identifier: Apache-2.0
// A web that is photographed while it passes.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/camera/kerf_tile.h"
#include "hil/run/model_machine.h"
#include "hil/scenario/case.h"
#include "hil/source/open.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::run {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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
  RecordedRun idle(double time_s) { return play({}, time_s); }

  /// The mirror is turned towards +x by `steps` of 12.5 urad, 500 mm above the web; when some labels have
  /// left the machine the laser fires.
  RecordedRun fireWithMirrorAt(int steps) {
    source::PinRecording pins;
    Levels levels{pins, test_case.machine.signals};
    levels.set(1.0, Signal::kGalvoXDir, true);
    for (int i = 0; i < steps; ++i) {
      levels.set(1.1 + 1e-4 * i, Signal::kGalvoXPul, true);
      levels.set(1.1 + 1e-4 * i + 5e-5, Signal::kGalvoXPul, false);
    }
    levels.set(8.0, Signal::kLaserPwm, true);
    levels.set(8.0, Signal::kLaserGate, true);
    levels.set(8.01, Signal::kLaserGate, false);
    return play(std::move(pins), 9.0);
  }

  /// Writes levels of the machine's pins, in order of time.
  struct Levels {
    source::PinRecording& pins;
    const SignalMap& map;
    std::map<std::uint16_t, std::uint16_t> of_port{};

    void set(double time_s, Signal signal, bool high) {
      const PinId pin = map.pin(signal).value();
      const auto mask = static_cast<std::uint16_t>(1U << pin.bit);
      std::uint16_t& level = of_port[pin.port];
      level = static_cast<std::uint16_t>(high ? level | mask : level & ~mask);
      pins.outputs.push_back({pins.rate.ticksAt(time_s), pin.port, mask, level, 0});
    }
  };

  RecordedRun play(source::PinRecording pins, double time_s) {
    pins.end = pins.rate.ticksAt(time_s);
    LockstepOptions lockstep;
    lockstep.time_limit_s = time_s;
    return machine.run(*source::openRecording(std::move(pins), "pins"), nullptr, lockstep, {});
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

TEST_F(PassingWebOfLabels, ABeamOnWebThatIsTakenAwaySpoilsTheRun) {
  ASSERT_TRUE(machine.kerfTilesMeanwhile(1, kAll));
  EXPECT_THAT(fireWithMirrorAt(12'000).problems, ElementsAre(HasSubstr("web that had left the machine")));
}

TEST_F(PassingWebOfLabels, ABeamAtTheEdgeOfItsFieldDoesNot) {
  ASSERT_TRUE(machine.kerfTilesMeanwhile(1, kAll));
  EXPECT_THAT(fireWithMirrorAt(6'000).problems, IsEmpty());
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
