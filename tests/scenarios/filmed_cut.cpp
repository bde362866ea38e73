// SPDX-License-Identifier: Apache-2.0
#include "tests/scenarios/filmed_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/base/stopwatch.h"
#include "hil/camera/twin/twin_frames.h"
#include "hil/judge/judge.h"
#include "hil/live/spot_recorder.h"
#include "hil/run/lockstep.h"
#include "hil/source/open.h"

namespace kerfbench::test {
namespace {

constexpr double kMargin_s = 0.3;

std::int64_t nanoseconds(double time_s) { return std::llround(1e9 * time_s); }

scenario::Case caseOf(const std::filesystem::path& scenario) {
  return scenario::readCase(scenario, KERFBENCH_BINARY_DIR "/firmware");
}

run::CutSheet cutByRelease(const scenario::Case& test_case) {
  return run::cutOnTwin(test_case, KERFBENCH_BINARY_DIR "/bin", [](double, const std::string&) {});
}

run::CutSheet cutByPins(const scenario::Case& test_case, const std::filesystem::path& pins) {
  run::CutSheet cut;
  cut.sampled = scenario::sampledMachine(test_case);
  const auto source = source::openVcd(pins, test_case.machine.signals);
  cut.twin = std::make_unique<twin::Twin>(cut.sampled.machine, scenario::webOf(test_case),
                                          source->info().rate, run::twinOptions(test_case));
  run::LockstepOptions lockstep;
  lockstep.time_limit_s = test_case.scenario.time_limit_s;
  cut.run = run::runLockstep(*source, *cut.twin, test_case.machine.signals, nullptr, lockstep, {});
  return cut;
}

}  // namespace

FilmedCut::FilmedCut(const std::filesystem::path& scenario)
    : FilmedCut(caseOf(scenario), cutByRelease(caseOf(scenario))) {}

FilmedCut::FilmedCut(const std::filesystem::path& scenario, const std::filesystem::path& pins)
    : FilmedCut(caseOf(scenario), cutByPins(caseOf(scenario), pins)) {}

FilmedCut::FilmedCut(scenario::Case test_case, run::CutSheet cut)
    : case_(std::move(test_case)), cut_(std::move(cut)) {
  const auto gates = cut_.twin->gateIntervals();
  // judge() takes the exposures of its own twin; a real camera's are its own.
  exposures_ = cut_.twin->takeExposures();
  std::erase_if(exposures_, [&](const twin::Exposure& e) {
    return gates.empty() || e.start_s < gates.front().first - kMargin_s ||
           e.start_s > gates.back().second + kMargin_s;
  });
}

std::vector<kerfbench::Frame> FilmedCut::frames() const {
  camera::TwinFrameSource source(
      twin::SpotCamera(case_.machine.spot_camera, case_.scenario.print, case_.machine.glow_gray_per_w, 99),
      exposures_, 2);
  return source.nextBatch(exposures_.size());
}

std::unique_ptr<camera::FakeVideo> FilmedCut::camera(double drift) const {
  auto video = std::make_unique<camera::FakeVideo>(case_.scenario.cameras.spot.device);
  video->addControl(V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", 0, 3, V4L2_EXPOSURE_MANUAL);
  video->addControl(V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 1, 10'000, 50);
  constexpr std::int64_t kTransfer_ns = 3'000'000;
  for (kerfbench::Frame& frame : frames()) {
    camera::FakeFrame buffer;
    buffer.bytes = std::move(frame.image.pixels);
    buffer.sequence = static_cast<std::uint32_t>(frame.sequence);
    buffer.stamp_ns = nanoseconds((1.0 + drift) * frame.start_s + kOffset_s);
    buffer.arrival_ns = buffer.stamp_ns + kTransfer_ns;
    video->frames.push_back(std::move(buffer));
  }
  video->now_ns = video->frames.front().stamp_ns;
  return video;
}

std::size_t FilmedCut::frameAt(const camera::FakeVideo& camera, double pins_s) const {
  const auto after = std::ranges::upper_bound(camera.frames, nanoseconds(pins_s + kOffset_s), {},
                                              &camera::FakeFrame::stamp_ns);
  return static_cast<std::size_t>(after - camera.frames.begin());
}

std::vector<double> FilmedCut::begins_s() const {
  std::vector<double> begins;
  for (const twin::Exposure& exposure : exposures_) begins.push_back(exposure.start_s);
  return begins;
}

double FilmedCut::middleOfACut_s() const {
  const auto gates = cut_.twin->gateIntervals();
  const auto longest = std::ranges::max_element(gates, {}, [](const auto& g) { return g.second - g.first; });
  return 0.5 * (longest->first + longest->second);
}

std::string FilmedCut::record(camera::FakeVideo& camera, const std::filesystem::path& folder) const {
  const live::OpenSpotCamera open = live::openSpotCamera(case_, camera);
  camera::FrameRecordingWriter writer(folder, open.camera);
  return camera::recordFrames(*open.stream, writer, live::recordOptions(open), [] { return false; });
}

report::RunReport FilmedCut::judged(const std::filesystem::path& recording, int jobs) const {
  report::RunReport report;
  base::Stopwatch stopwatch;
  judge::judge(
      case_, *cut_.twin, cut_.run, {}, {recording}, jobs, stopwatch, [](double, const std::string&) {},
      report);
  return report;
}

}  // namespace kerfbench::test
