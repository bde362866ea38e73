// SPDX-License-Identifier: Apache-2.0
#include "hil/live/recording_file.h"

#include <algorithm>

#include "hil/run/release.h"
#include "hil/scenario/analyser_choice.h"
#include "hil/source/analyser/sr_file.h"

namespace kerfbench::live {
namespace {

bool hasEdges(const source::PinRecording& recording, PinId pin) {
  return std::ranges::any_of(recording.outputs, [&](const PinEvent& event) {
    return event.tick > 0 && event.port == pin.port && (event.changed >> pin.bit & 1U) != 0;
  });
}

source::PinRecording readSession(const std::filesystem::path& path, const scenario::Case& the_case) {
  source::ChannelNames names;
  for (const scenario::PinLine& line : the_case.scenario.firmware.analyser.lines)
    names.emplace_back(line.signal, line.line);
  source::PinRecording recording = source::readSr(path, the_case.machine.signals, names);
  for (const scenario::SlowRate& slow : scenario::tooSlowFor(the_case.machine, recording.rate.den)) {
    if (hasEdges(recording, *the_case.machine.signals.pin(slow.pul)))
      recording.problems.push_back(slow.words);
  }
  return recording;
}

}  // namespace

source::PinRecording readRecording(const std::filesystem::path& path, const scenario::Case& the_case) {
  try {
    return path.extension() == ".sr" ? readSession(path, the_case)
                                     : source::readVcd(path, the_case.machine.signals);
  } catch (const std::runtime_error& e) {
    throw base::InputError(e.what());
  }
}

}  // namespace kerfbench::live
