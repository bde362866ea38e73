// SPDX-License-Identifier: Apache-2.0
#include "tests/scenarios/filmed_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/base/stopwatch.h"
#include "hil/camera/twin/twin_frames.h"
#include "hil/evidence/pin_evidence.h"
#include "hil/judge/judge.h"
#include "hil/judge/pin_wiring.h"
#include "hil/live/spot_recorder.h"
#include "hil/run/dialogs.h"
#include "hil/run/model_machine.h"
#include "hil/run/release.h"
#include "hil/run/twin_model.h"
#include "hil/source/open.h"
#include "tests/scenarios/twin_cameras.h"
#include "twin/base/image.h"

namespace kerfbench::test {
namespace {

constexpr double kMargin_s = 0.3;

std::int64_t nanoseconds(double time_s) { return std::llround(1e9 * time_s); }

scenario::Case caseOf(const std::filesystem::path& scenario) {
  return scenario::readCase(scenario, KERFBENCH_BINARY_DIR "/firmware");
}

}  // namespace

FilmedCut::FilmedCut(const std::filesystem::path& scenario) : case_(caseOf(scenario)) {
  const run::PreparedJob job = run::prepareJob(case_);
  const auto source = run::openRelease(case_.scenario.firmware, KERFBENCH_BINARY_DIR "/bin");
  cut(*source, job.dialog.get());
}

FilmedCut::FilmedCut(const std::filesystem::path& scenario, const std::filesystem::path& pins)
    : case_(caseOf(scenario)) {
  cut(*source::openVcd(pins, case_.machine.signals), nullptr);
}

void FilmedCut::cut(source::SignalSource& source, run::Dialog* dialog) {
  const twin::SampledMachine sampled = scenario::sampledMachine(case_);
  const run::ModelOptions options = run::modelOptions(case_);
  twin_ = std::make_unique<twin::Twin>(sampled.machine, scenario::webOf(case_), source.info().rate,
                                       twin::TwinOptions{.fidelity = options.fidelity, .seed = options.seed});
  run::TwinModel model(*twin_);
  run::LockstepOptions lockstep;
  lockstep.time_limit_s = case_.scenario.time_limit_s;
  run_ = run::runLockstep(source, model, case_.machine.signals, dialog, lockstep, {});
  gates_ = evidence::pinEvidence(run_.recording, judge::pinWiring(case_)).gates;
  exposures_ = twin_->takeExposures();
  std::erase_if(exposures_, [&](const twin::Exposure& e) {
    return gates_.empty() || e.start_s < gates_.front().on_s - kMargin_s ||
           e.start_s > gates_.back().off_s + kMargin_s;
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
  const auto longest = std::ranges::max_element(
      gates_, {}, [](const inspect::GateInterval& gate) { return gate.off_s - gate.on_s; });
  return 0.5 * (longest->on_s + longest->off_s);
}

std::string FilmedCut::record(camera::FakeVideo& camera, const std::filesystem::path& folder) const {
  const live::OpenSpotCamera open = live::openSpotCamera(case_, camera);
  camera::FrameRecordingWriter writer(folder, open.camera);
  return camera::recordFrames(*open.stream, writer, live::recordOptions(open), [] { return false; });
}

report::RunReport FilmedCut::judged(const std::filesystem::path& recording, int jobs) const {
  report::RunReport report;
  base::Stopwatch stopwatch;
  TwinCameras cameras(case_, *twin_);
  judge::addJudgement(judge::judge(case_, run_, {}, {cameras, recording, jobs},
                                   {stopwatch, [](double, const std::string&) {}}),
                      report);
  return report;
}

}  // namespace kerfbench::test
