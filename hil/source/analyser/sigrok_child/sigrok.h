// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "hil/source/analyser/analyser_stream.h"
#include "hil/source/analyser/level_runs.h"

namespace kerfbench::sigrok_child {

using Frame = source::analyser_stream::AnalyserFrame;

/// Receiver of frames; one that throws ends the work.
using Sink = std::function<void(Frame, const std::string& payload)>;

/// Failure before sampling begins; what() gives the reason in words.
class SigrokError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct AcquireRequest {
  std::string driver, conn, serial;
  std::uint64_t samplerate_hz{};
  std::vector<std::string> channels;
  std::vector<std::pair<std::string, std::string>> settings;
  source::ListenFor listen;
};

/// kLibrary, and kDevice or kFault for each logic analyser that a scan finds. @throws SigrokError.
void listAnalysers(const Sink& sink);

/// kStarted, kRuns, kProblem and kNote until the pins are quiet, the limit is reached or the device stops;
/// kFinished. @throws SigrokError before kStarted, or what the sink throws.
void acquire(const AcquireRequest& request, const Sink& sink);

}  // namespace kerfbench::sigrok_child
