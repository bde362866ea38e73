// SPDX-License-Identifier: Apache-2.0
#include "hil/app/kept_evidence.h"

#include <fmt/format.h>

#include <exception>
#include <string>

#include "hil/app/results_folder.h"
#include "hil/app/spot_recorder.h"
#include "hil/base/atomic_file.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/v4l2/frame_recording.h"

namespace kerfbench::hil {
namespace {

namespace fs = std::filesystem;

bool isWhole(const fs::path& frames) {
  if (frames.empty()) return false;
  try {
    const FrameRecording whole(frames);
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

std::string freeName(const fs::path& parent, const std::string& name) {
  std::string free = name;
  for (int number = 2; fs::exists(parent / free); ++number) free = fmt::format("{}-{}", name, number);
  return free;
}

void keep(const Case& the_case, const PinRecording& recording, const fs::path& frames,
          const fs::path& results_dir, Console& console) {
  ResultsFolder folder(results_dir, freeName(results_dir, the_case.scenario.name + "-capture"));
  writeVcd(folder.staging() / "pins.vcd", recording, the_case.machine.signals);
  writeFileAtomically(folder.staging() / "scenario.yaml", the_case.scenario.text);
  const bool whole = isWhole(frames);
  if (whole) fs::rename(frames, folder.staging() / kSpotFrames);
  folder.commit();
  console.result(fmt::format("what was recorded is kept in {}{}\njudge it: ./bench replay {} --scenario {}",
                             folder.place().string(),
                             whole || frames.empty() ? "" : "; the frames are not whole, and are lost",
                             (folder.place() / "pins.vcd").string(), the_case.scenario.path.string()));
}

}  // namespace

void keepEvidence(const Case& the_case, const PinRecording& recording, const fs::path& frames,
                  const fs::path& results_dir, Console& console) noexcept {
  try {
    keep(the_case, recording, frames, results_dir, console);
  } catch (const std::exception& e) {
    console.result(std::string("what was recorded could not be kept: ") + e.what());
  }
}

}  // namespace kerfbench::hil
