// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/inspect/evidence/pin_evidence.h"
#include "hil/report/run_report.h"
#include "hil/run/dialog.h"
#include "hil/run/lockstep.h"
#include "hil/scenario/case.h"
#include "hil/source/signal_source.h"
#include "tests/hil/camera/v4l2/fake_video.h"
#include "twin/camera/camera.h"
#include "twin/cutter/twin.h"

namespace kerfbench::test {

/// A sheet that is cut on the twin before a spot camera of V4L2: the pictures of the twin's spot camera come
/// out of a fake device, whose clock is not that of the pins.
class FilmedCut {
 public:
  static constexpr double kOffset_s = 7123.456789;  ///< Lead of the camera's clock over the pins'.

  /// Cuts by the scenario's release, or by recorded pins (VCD).
  explicit FilmedCut(const std::filesystem::path& scenario);
  FilmedCut(const std::filesystem::path& scenario, const std::filesystem::path& pins);

  /// Frames of the twin's camera from a little before the first cut to a little after the last, on the clock
  /// of the pins.
  [[nodiscard]] std::vector<kerfbench::Frame> frames() const;

  /// Device with all frames(), each there 3 ms after its stamp.
  [[nodiscard]] std::unique_ptr<camera::FakeVideo> camera(double drift = 0.0) const;
  /// Index in FakeVideo::frames of the frame that is pending at a time of the pins.
  [[nodiscard]] std::size_t frameAt(const camera::FakeVideo& camera, double pins_s) const;
  /// Begins of the exposures, on the clock of the pins.
  [[nodiscard]] std::vector<double> begins_s() const;
  /// Time of the middle of the longest cut.
  [[nodiscard]] double middleOfACut_s() const;

  /// Records the device with the options of the case, until it falls silent. Returns why it ended.
  std::string record(camera::FakeVideo& camera, const std::filesystem::path& folder) const;
  /// Replay of a recording.
  [[nodiscard]] report::RunReport judged(const std::filesystem::path& recording, int jobs = 2) const;

  [[nodiscard]] const scenario::Case& theCase() const { return case_; }
  [[nodiscard]] const run::RecordedRun& run() const { return run_; }
  [[nodiscard]] const std::vector<inspect::GateInterval>& gates() const { return gates_; }

 private:
  void cut(source::SignalSource& source, run::Dialog* dialog);

  scenario::Case case_;
  std::unique_ptr<twin::Twin> twin_;
  run::RecordedRun run_;
  std::vector<inspect::GateInterval> gates_;
  std::vector<twin::Exposure> exposures_;
};

}  // namespace kerfbench::test
