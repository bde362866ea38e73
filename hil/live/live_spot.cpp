// SPDX-License-Identifier: Apache-2.0
#include "hil/live/live_spot.h"

#include <fmt/format.h>

#include "hil/run/release.h"

namespace kerfbench::live {
namespace {

namespace fs = std::filesystem;

}  // namespace

LiveSpot::LiveSpot(const scenario::Case& test_case, const fs::path& results_dir, base::Console& console) {
  if (!test_case.scenario.cameras.spot.is_real) return;
  scratch_.emplace(results_dir, test_case.scenario.name + "-frames");
  recorder_.emplace(test_case, camera::kernelVideoCalls(), scratch_->staging() / judge::kSpotFrames);
  const camera::RecordedCamera& camera = recorder_->camera();
  console.say(fmt::format("  recording {} ({})", camera.device, camera.card));
  for (const camera::SettingOutcome& one : camera.setup.outcomes)
    console.say(fmt::format("  {}: {:g}, the camera has {:g}", one.setting, one.wanted, one.got));
}

void LiveSpot::finish(judge::Conclusion& conclusion, base::Console& console) {
  if (!recorder_) return;
  const std::string ended = recorder_->finish();
  console.say(
      fmt::format("  {} frames{}", recorder_->frames(), ended.empty() ? "" : "; the camera ended: " + ended));
  conclusion.spot_frames = frames();
  conclusion.moves_frames = true;
}

fs::path LiveSpot::frames() const { return scratch_ ? scratch_->staging() / judge::kSpotFrames : fs::path(); }

fs::path framesOfReplay(const scenario::Case& test_case, const fs::path& pins, const fs::path& frames) {
  const scenario::SpotCameraChoice& spot = test_case.scenario.cameras.spot;
  if (!spot.is_real) {
    if (frames.empty()) return {};
    throw base::InputError(fmt::format("{}: has no real spot camera (cameras.spot), so no frames to judge",
                                       test_case.scenario.path.string()));
  }
  const fs::path folder = frames.empty() ? fs::absolute(pins).parent_path() / judge::kSpotFrames : frames;
  if (fs::is_directory(folder)) return folder;
  throw base::InputError(
      fmt::format("{}: the spot camera is real, and there is no recording of its frames in {}", spot.place,
                  folder.string()));
}

void refuseRealCamera(const scenario::Case& test_case) {
  const scenario::SpotCameraChoice& spot = test_case.scenario.cameras.spot;
  if (spot.is_real)
    throw base::InputError(
        fmt::format("{}: the pins are emulated, so a real camera sees nothing of them; run on real pins "
                    "(firmware.source: gpio, analyser), or replay with --frames",
                    spot.place));
}

void refuseKerfPictures(const scenario::Case& test_case) {
  const scenario::KerfCameraChoice& kerf = test_case.scenario.cameras.kerf;
  if (kerf.tiles.empty()) return;
  throw base::InputError(fmt::format(
      "{}: pictures that are there before a sheet is cut are not of it. First cut and record with kerf: "
      "{{source: twin}} (`run`; or `capture`, and `record-frames` for a real spot camera), then photograph "
      "that "
      "sheet, then judge it with {{source: tiles}}: ./bench replay PINS.vcd --scenario {}",
      kerf.place, test_case.scenario.path.string()));
}

}  // namespace kerfbench::live
