// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/base/console.h"
#include "hil/controller/uart_listener.h"
#include "hil/evidence/counted_steps.h"
#include "hil/judge/run_options.h"
#include "hil/report/run_report.h"
#include "hil/run/onlooker.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"
#include "hil/trace/run/burnt_path.h"
#include "hil/trace/run/kept_frames.h"
#include "hil/trace/run/known_program.h"
#include "hil/trace/run/motion_batch.h"
#include "hil/trace/run/overview.h"
#include "hil/trace/run/program_follower.h"
#include "hil/trace/run/wired_signals.h"
#include "hil/trace/trace_file.h"
#include "twin/optics/surface.h"

namespace kerfbench::trace {

/// What a trace is made of, besides what it sees.
struct TraceSource {
  const scenario::Case& test_case;
  const twin::MachineDescription& machine;  ///< The one that runs.
  TickRate rate;
  std::string folder_name;  ///< Folder of its results, below the results folder.
  std::string firmware;     ///< For people.
  std::string source_id;
  KnownProgram program;
  const source::PinRecording*
      recorded{};      ///< The recording of a replay: what no lockstep tells of it, sensors and words.
  int frames_every{};  ///< Every Nth frame of the spot camera is kept; 0: none.
  std::filesystem::path part{};  ///< Where it grows.
};

/// Where a trace grows: beside the folder `output`, or in that of the scenario's name below `results_dir`.
std::filesystem::path growingTrace(const std::filesystem::path& results_dir, const std::string& name,
                                   const std::filesystem::path& output);

/// Writes the trace of a run while it goes on. The file has the same bytes at any number of threads. If
/// finish() is never called, what was written stays where it grew.
class RunTrace final : public run::Onlooker {
 public:
  /// What of `source` is a reference or a pointer must outlive it. @throws std::system_error with the path if
  /// the file cannot be made; so do the others when it cannot be written.
  explicit RunTrace(TraceSource source);
  ~RunTrace() override;

  void begins(const run::MachineState& state, TickRate rate) override;
  void saw(const run::Quantum& quantum, const run::MachineState& state) override;
  void sawFrame(const Frame& frame) override;

  /// The run was judged: writes kTraceFile into a folder, and removes the file that grew.
  /// `clip_page`: see clipPage(); where it is, the first moments of the report get a page each.
  void finish(report::RunReport& report, const report::Digests& digests, const std::filesystem::path& folder,
              const std::filesystem::path& clip_page);

 private:
  struct Parts;  ///< What is known only when the run begins.

  void takeEdges(const run::Quantum& quantum);
  void takeWords(const run::Quantum& quantum);
  void say(double time_s, const char* who, int level, const std::string& words,
           std::span<const std::uint8_t> bytes);
  void takeRow(const run::MachineState& state);
  void takeCommanded(const run::MachineState& state);
  void endBatch();
  void endParts();
  void addJudgement(const report::RunReport& report, TraceFile& whole) const;
  [[nodiscard]] std::map<std::string, std::string> runFacts() const;
  [[nodiscard]] std::vector<SensorEdge> recordedSensors(Tick until);
  [[nodiscard]] std::span<const std::uint8_t> recordedWords(Tick until);

  TraceSource source_;
  std::unique_ptr<TraceFile> file_;
  KeptFrames frames_;
  std::unique_ptr<Parts> parts_;
};

/// The trace that was asked for, and says where it grows; null: none was. `source` without what the options
/// say.
std::unique_ptr<RunTrace> tracing(TraceSource source, const judge::RunOptions& options,
                                  base::Console& console);
/// Makes a Conclusion::finish_trace; empty for null.
std::function<void(report::RunReport&, const report::Digests&, const std::filesystem::path&)> finishing(
    RunTrace* traced, const judge::RunOptions& options, base::Console& console);

}  // namespace kerfbench::trace
