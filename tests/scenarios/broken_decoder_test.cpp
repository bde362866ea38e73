// SPDX-License-Identifier: Apache-2.0
// The judge reads the pins by itself: where the twin's decoder of PUL and DIR is wrong, the judge notices.
// Only the twin's pins are falsified; the recording has those of the release.
#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/inspect/inspect.h"
#include "hil/judge/judge.h"
#include "hil/judge/pin_wiring.h"
#include "hil/run/dialogs.h"
#include "hil/run/model_machine.h"
#include "hil/run/release.h"
#include "hil/run/twin_model.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/scenarios/twin_cameras.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;

/// A change of one line.
struct LineEdge {
  Tick tick{};
  PinId pin;
  bool level{};
};

std::vector<LineEdge> edgesOf(const std::vector<PinEvent>& events) {
  std::vector<LineEdge> edges;
  for (const PinEvent& event : events) {
    for (std::uint16_t bit = 0; bit < 16; ++bit) {
      if ((event.changed >> bit & 1U) != 0)
        edges.push_back({event.tick, {event.port, bit}, (event.level >> bit & 1U) != 0});
    }
  }
  return edges;
}

std::vector<PinEvent> eventsOf(std::vector<LineEdge> edges) {
  std::ranges::stable_sort(edges, {}, &LineEdge::tick);
  std::map<std::uint16_t, std::uint16_t> levels;
  std::vector<PinEvent> events;
  for (const LineEdge& edge : edges) {
    const auto mask = static_cast<std::uint16_t>(1U << edge.pin.bit);
    std::uint16_t& level = levels[edge.pin.port];
    level = static_cast<std::uint16_t>(edge.level ? level | mask : level & ~mask);
    events.push_back({edge.tick, edge.pin.port, mask, level, 0});
  }
  return events;
}

/// Delays each change of `dir` to `late` ticks before the next rising edge of `pul`.
std::vector<PinEvent> withLateDirection(const std::vector<PinEvent>& events, PinId pul, PinId dir,
                                        Tick late) {
  std::vector<LineEdge> edges = edgesOf(events);
  for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
    if (edge->pin != dir) continue;
    const auto next =
        std::find_if(edge, edges.end(), [&](const LineEdge& e) { return e.pin == pul && e.level; });
    if (next != edges.end()) edge->tick = std::max(edge->tick, next->tick - late);
  }
  return eventsOf(std::move(edges));
}

/// A decoder that overlooks a pulse now and then: its machine does less than the pins command.
class OverlooksPulses final : public run::LockstepModel {
 public:
  OverlooksPulses(run::LockstepModel& model, PinId pul) : model_(model), pul_(pul) {}
  std::vector<SensorEdge> predictSensors(Tick until) override { return model_.predictSensors(until); }
  [[nodiscard]] double longestQuantum_s() const override { return model_.longestQuantum_s(); }
  void advance(Tick until, std::span<const PinEvent> events) override {
    constexpr int kOverlooked = 200;
    std::vector<PinEvent> seen(events.begin(), events.end());
    const auto mask = static_cast<std::uint16_t>(1U << pul_.bit);
    for (PinEvent& event : seen) {
      if (event.port != pul_.port) continue;
      const bool high = (event.level & mask) != 0;
      if (high && !was_high_) hides_ = ++pulses_ % kOverlooked == 0;
      was_high_ = high;
      if (hides_) event.level = static_cast<std::uint16_t>(event.level & ~mask);
    }
    model_.advance(until, seen);
  }

 private:
  run::LockstepModel& model_;
  PinId pul_;
  int pulses_{0};
  bool was_high_{false};
  bool hides_{false};
};

/// The strip's crosscut, cut by the reference release.
class BrokenDecoder : public testing::Test {
 protected:
  /// Cuts the strip; with `overlooks` the twin's decoder is broken.
  void cut(bool overlooks) {
    const auto source = run::openRelease(case_.scenario.firmware, fs::path(KERFBENCH_BINARY_DIR) / "bin");
    twin_.emplace(scenario::sampledMachine(case_).machine, scenario::webOf(case_), source->info().rate,
                  twin::TwinOptions{.fidelity = twin::Fidelity::kFast, .seed = case_.scenario.seed});
    run::TwinModel whole(*twin_);
    OverlooksPulses broken(whole, wired(Signal::kGantryYPul));
    run::LockstepModel& model = overlooks ? static_cast<run::LockstepModel&>(broken) : whole;
    run::PreparedJob job = run::prepareJob(case_);
    run::LockstepOptions options;
    options.time_limit_s = case_.scenario.time_limit_s;
    run_ = run::runLockstep(*source, model, case_.machine.signals, job.dialog.get(), options, {});
    ASSERT_THAT(run_.problems, testing::IsEmpty());
  }
  [[nodiscard]] PinId wired(Signal signal) const { return case_.machine.signals.pin(signal).value(); }
  judge::Judgement judged() {
    TwinCameras cameras(case_, *twin_);
    base::Stopwatch stopwatch;
    return judge::judge(case_, run_, {}, {cameras, {}, 2}, {stopwatch, [](double, const std::string&) {}});
  }
  static inspect::Verdict verdictOf(const judge::Judgement& judgement, const std::string& check) {
    for (const inspect::Check& each : judgement.result.checks) {
      if (each.name == check) return each.verdict;
    }
    ADD_FAILURE() << "no check " << check;
    return inspect::Verdict::kInvalid;
  }

  static scenario::Case readStrip() {
    const base::TempFolder folder;
    const fs::path one = folder.write(
        "one.yaml", "extends: '" + base::fixture("scenarios/native/strip-crosscut.yaml").string() +
                        "'\nprint: {units: 1}\n");
    return scenario::readCase(one, fs::path(KERFBENCH_BINARY_DIR) / "firmware");
  }

  scenario::Case case_ = readStrip();
  std::optional<twin::Twin> twin_;
  run::RecordedRun run_;
};

TEST_F(BrokenDecoder, ThatForgivesALateDirectionDoesNotVouchForThePulses) {
  cut(false);
  const double late_s = 0.5 * case_.machine.gantry_y.profile.setup_s;
  ASSERT_GT(late_s, 0.0);
  const std::vector<PinEvent> events(run_.recording.outputs.begin(), run_.recording.outputs.end());
  run_.recording.outputs = source::PinEvents(withLateDirection(
      events, wired(Signal::kGantryYPul), wired(Signal::kGantryYDir), run_.recording.rate.ticksAt(late_s)));
  const judge::Judgement judgement = judged();
  EXPECT_EQ(verdictOf(judgement, "path"),
            inspect::Verdict::kPass);  // The machine made the intended cut of them.
  EXPECT_EQ(verdictOf(judgement, "pulse_timing"), inspect::Verdict::kFail);
  EXPECT_EQ(judgement.result.verdict, inspect::Verdict::kFail);
}

TEST_F(BrokenDecoder, ThatOverlooksPulsesIsSeenInTheCut) {
  cut(true);
  const judge::Judgement judgement = judged();
  EXPECT_EQ(verdictOf(judgement, "pulse_timing"), inspect::Verdict::kPass);
  EXPECT_EQ(judgement.result.verdict, inspect::Verdict::kFail);
}

}  // namespace
}  // namespace kerfbench::test
