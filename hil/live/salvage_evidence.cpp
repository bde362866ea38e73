// SPDX-License-Identifier: Apache-2.0
#include "hil/live/salvage_evidence.h"

#include <fmt/format.h>

#include <exception>
#include <string>

#include "hil/base/atomic_file.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/v4l2/frame_recording.h"
#include "hil/judge/results_folder.h"
#include "hil/live/spot_recorder.h"

namespace kerfbench::live {
namespace {

namespace fs = std::filesystem;

bool isWhole(const fs::path& frames) {
  if (frames.empty()) return false;
  try {
    const camera::FrameRecording whole(frames);
    return true;
  } catch (const base::ConfigError&) {
    return false;
  }
}

std::string freeName(const fs::path& parent, const std::string& name) {
  std::string free = name;
  for (int number = 2; fs::exists(parent / free); ++number) free = fmt::format("{}-{}", name, number);
  return free;
}

void keep(const scenario::Case& test_case, const source::PinRecording& recording, const fs::path& frames,
          const fs::path& results_dir, base::Console& console) {
  judge::ResultsFolder folder(results_dir, freeName(results_dir, test_case.scenario.name + "-capture"));
  source::writeVcd(folder.staging() / "pins.vcd", recording, test_case.machine.signals);
  base::writeFileAtomically(folder.staging() / "scenario.yaml", test_case.scenario.text);
  const bool whole = isWhole(frames);
  if (whole) fs::rename(frames, folder.staging() / judge::kSpotFrames);
  folder.commit();
  console.result(fmt::format("what was recorded is kept in {}{}\njudge it: ./bench replay {} --scenario {}",
                             folder.place().string(),
                             whole || frames.empty() ? "" : "; the frames are not whole, and are lost",
                             (folder.place() / "pins.vcd").string(), test_case.scenario.path.string()));
}

}  // namespace

void salvageEvidence(const scenario::Case& test_case, const source::PinRecording& recording,
                     const fs::path& frames, const fs::path& results_dir, base::Console& console) noexcept {
  try {
    keep(test_case, recording, frames, results_dir, console);
  } catch (const std::exception& e) {
    console.result(std::string("what was recorded could not be kept: ") + e.what());
  }
}

}  // namespace kerfbench::live
