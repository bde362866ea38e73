// SPDX-License-Identifier: Apache-2.0
#include "hil/live/recording_file.h"

#include <algorithm>

#include "hil/run/release.h"
#include "hil/scenario/analyser_choice.h"
#include "hil/scenario/pul_axes.h"
#include "hil/source/analyser/sr_file.h"

namespace kerfbench::live {
namespace {

bool hasEdges(const source::PinRecording& recording, PinId pin) {
  return std::ranges::any_of(recording.outputs, [&](const PinEvent& event) {
    return event.tick > 0 && event.port == pin.port && (event.changed >> pin.bit & 1U) != 0;
  });
}

/// Outputs that the machine makes no use of.
std::vector<Signal> spareOf(const scenario::Case& test_case) {
  return scenario::spareOutputs(test_case.machine, test_case.scenario.belt_by_controller);
}

/// All outputs that the machine makes use of, by the scenario's names or their own: none of them may be
/// missing.
source::ChannelNames namesOf(const scenario::Case& test_case) {
  source::ChannelNames names = test_case.scenario.wires;
  const std::vector<Signal> spare = spareOf(test_case);
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    const bool is_named =
        std::ranges::find(names, signal, &source::ChannelNames::value_type::first) != names.end();
    const bool is_spare = std::ranges::find(spare, signal) != spare.end();
    if (!is_named && !is_spare && !isSensor(signal) && test_case.machine.signals.hasOwnWire(signal))
      names.emplace_back(signal, signalName(signal));
  }
  return names;
}

/// Whether a pin is low until its first edge, and not only until the levels at the start are told.
bool startsLow(const source::PinRecording& recording, PinId pin) {
  for (const PinEvent& event : recording.outputs) {
    if (event.tick > 1) break;
    if (event.port == pin.port && (event.level >> pin.bit & 1U) != 0) return false;
  }
  return true;
}

/// Files of other programs tell levels of real pins, or of pins that something drives.
void tellWrongStart(const twin::MachineDescription& machine, source::PinRecording& recording) {
  if (recording.own) return;
  const source::StartLevels wanted = scenario::startLevels(machine);
  for (const Signal signal : wanted.high) {
    const std::optional<PinId> pin = machine.signals.pin(signal);
    if (!pin || !startsLow(recording, *pin)) continue;
    const std::string words = source::wrongAtStartWords(signal, false, wanted);
    if (std::ranges::find(recording.problems, words) == recording.problems.end())
      recording.problems.push_back(words);
  }
}

source::PinRecording readSession(const std::filesystem::path& path, const scenario::Case& test_case,
                                 const base::ProgressFn& progress) {
  source::ChannelNames names;
  for (const scenario::PinLine& line : test_case.scenario.firmware.analyser.lines)
    names.emplace_back(line.signal, line.line);
  if (names.empty()) names = namesOf(test_case);
  source::PinRecording recording = source::readSr(path, test_case.machine.signals, names, progress);
  for (const scenario::SlowRate& slow : scenario::tooSlowFor(test_case.machine, recording.rate.den)) {
    if (hasEdges(recording, *test_case.machine.signals.pin(slow.pul)))
      recording.problems.push_back(slow.words);
  }
  return recording;
}

}  // namespace

source::PinRecording readRecording(const std::filesystem::path& path, const scenario::Case& test_case,
                                   const base::ProgressFn& progress) {
  try {
    source::PinRecording recording =
        path.extension() == ".sr" ? readSession(path, test_case, progress)
                                  : source::readVcd(path, test_case.machine.signals, test_case.scenario.wires,
                                                    spareOf(test_case), progress);
    tellWrongStart(test_case.machine, recording);
    return recording;
  } catch (const std::runtime_error& e) {
    throw base::InputError(e.what());
  }
}

}  // namespace kerfbench::live
