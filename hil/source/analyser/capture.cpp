// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hil/source/analyser/run_recorder.h"

namespace kerfbench::source {
namespace {

std::uint64_t samplesOf(double time_s, std::uint64_t samplerate_hz) {
  const double samples = std::ceil(time_s * static_cast<double>(samplerate_hz));
  if (!(samples >= 1.0 && samples < 1e15)) throw std::invalid_argument("a time that is no number of samples");
  return static_cast<std::uint64_t>(samples);
}

AnalyserRequest captureRequest(const AnalyserCaptureOptions& options) {
  if (options.request.samplerate_hz == 0 || options.request.channels.size() != options.signals.size())
    throw std::invalid_argument("an analyser needs a rate, and a signal for each channel");
  AnalyserRequest request = options.request;
  request.listen = {samplesOf(options.quiet_s, request.samplerate_hz),
                    samplesOf(options.time_limit_s, request.samplerate_hz)};
  return request;
}

std::string stoppedWords(const AnalyserRequest& request, std::uint64_t samples) {
  return fmt::format(
      "the analyser stopped by itself after {} samples, {:.6f} s at {} Hz: it was too slow for this rate "
      "(another "
      "USB port, a lower rate, fewer channels), its memory is full, or it was unplugged",
      samples, static_cast<double>(samples) / static_cast<double>(request.samplerate_hz),
      request.samplerate_hz);
}

/// Reasons not to trust the capture.
std::vector<std::string> problemsOf(const AnalyserCaptureOptions& options, const AnalyserRequest& request,
                                    const RunRecorder& heard, const AnalyserEnd& end, bool too_many) {
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < options.signals.size(); ++i) {
    const bool level = (heard.firstLevels() >> i & 1U) != 0;
    if (const std::string words = wrongAtStartWords(options.signals[i], level, options.at_start);
        !words.empty())
      problems.push_back(words);
  }
  if (too_many) {
    problems.emplace_back(kTooManyEdgesWords);
    return problems;
  }
  problems.insert(problems.end(), end.problems.begin(), end.problems.end());
  if (end.reason == AnalyserEnd::Reason::kLimit)
    problems.push_back(timeLimitWords(options.time_limit_s, heard.edges() > 0));
  if (end.reason == AnalyserEnd::Reason::kDevice) problems.push_back(stoppedWords(request, heard.samples()));
  return problems;
}

PinRecording recordingOf(RunRecorder& heard, std::uint64_t samplerate_hz) {
  const std::uint64_t lead = samplesOf(kLeadBeforeEdges_s, samplerate_hz);
  const std::uint64_t tail = samplesOf(kTailAfterEdges_s, samplerate_hz);
  // The levels at the start have tick 1, and the first edge comes later than both.
  const bool early = heard.firstEdge() <= lead;
  const auto origin = early ? std::int64_t{-1} : static_cast<std::int64_t>(heard.firstEdge() - lead);
  const auto last = static_cast<Tick>(static_cast<std::int64_t>(heard.lastEdge()) - origin);
  const Tick end = heard.edges() == 0 ? tail : last + tail;
  return heard.takeRecording(samplerate_hz, {.origin = origin, .start = 1, .end = end});
}

}  // namespace

PinCapture captureAnalyser(const AnalyserCaptureOptions& options, const SignalMap& map,
                           AnalyserSystem& system) {
  RunRecorder heard(options.signals, map);
  if (std::ranges::any_of(options.signals, isSensor))
    throw std::invalid_argument("an analyser listens to outputs of the controller");
  const AnalyserRequest request = captureRequest(options);
  const auto feed = system.acquire(request);
  std::vector<LevelRun> runs;
  bool too_many = false;
  while (!too_many && feed->read(runs)) {
    for (const LevelRun& run : runs) heard.add(run);
    runs.clear();
    too_many = heard.edges() > kMostSampledEdges;
  }
  const AnalyserEnd end = feed->end();
  PinCapture captured;
  captured.recording = recordingOf(heard, request.samplerate_hz);
  captured.edges = heard.edges();
  captured.notes = end.notes;
  captured.recording.problems = problemsOf(options, request, heard, end, too_many);
  if (!options.signals.empty()) spoilEnd(captured.recording, map.pin(options.signals.front())->port);
  return captured;
}

}  // namespace kerfbench::source
