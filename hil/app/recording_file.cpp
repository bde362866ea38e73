// SPDX-License-Identifier: Apache-2.0
#include "hil/app/recording_file.h"

#include <algorithm>

#include "hil/app/analyser_choice.h"
#include "hil/app/release.h"
#include "hil/source/analyser/sr_file.h"

namespace kerfbench::hil {
namespace {

bool hasEdges(const PinRecording& recording, PinId pin) {
  return std::ranges::any_of(recording.outputs, [&](const PinEvent& event) {
    return event.tick > 0 && event.port == pin.port && (event.changed >> pin.bit & 1U) != 0;
  });
}

PinRecording readSession(const std::filesystem::path& path, const Case& the_case) {
  ChannelNames names;
  for (const PinLine& line : the_case.scenario.firmware.analyser.lines)
    names.emplace_back(line.signal, line.line);
  PinRecording recording = readSr(path, the_case.machine.signals, names);
  for (const SlowRate& slow : tooSlowFor(the_case.machine, recording.rate.den)) {
    if (hasEdges(recording, *the_case.machine.signals.pin(slow.pul)))
      recording.problems.push_back(slow.words);
  }
  return recording;
}

}  // namespace

PinRecording readRecording(const std::filesystem::path& path, const Case& the_case) {
  try {
    return path.extension() == ".sr" ? readSession(path, the_case) : readVcd(path, the_case.machine.signals);
  } catch (const std::runtime_error& e) {
    throw InputFault(e.what());
  }
}

}  // namespace kerfbench::hil
