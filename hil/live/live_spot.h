// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "hil/base/console.h"
#include "hil/judge/conclude.h"
#include "hil/judge/results_folder.h"
#include "hil/live/spot_recorder.h"
#include "hil/scenario/case.h"

namespace kerfbench::live {

/// The real spot camera of a run on real pins, if the case has one: recorded from here until finish(), in the
/// folder of the results.
class LiveSpot {
 public:
  /// @throws as openSpotCamera() for a camera that cannot be had, std::system_error.
  LiveSpot(const scenario::Case& test_case, const std::filesystem::path& results_dir, base::Console& console);
  /// Ends the recording and names it to the conclusion, which takes it into the results. This must live until
  /// then.
  void finish(judge::Conclusion& conclusion, base::Console& console);
  /// Folder of the frames until somebody takes them; empty for a case without such a camera.
  [[nodiscard]] std::filesystem::path frames() const;

 private:
  std::optional<judge::ResultsFolder> scratch_;
  std::optional<SpotRecorder> recorder_;
};

/// The recording that a replay of a case with a real spot camera judges: `frames`, or where that is empty the
/// folder next to the pins. Empty for a case without such a camera. @throws InputError where there is none,
/// or one too many.
std::filesystem::path framesOfReplay(const scenario::Case& test_case, const std::filesystem::path& pins,
                                     const std::filesystem::path& frames);

/// @throws InputError for a case whose pins are emulated: a real camera sees nothing of them.
void refuseRealCamera(const scenario::Case& test_case);

/// Check before a sheet is cut. @throws InputError for a case whose kerf pictures are there already: they are
/// of an earlier sheet, and would pass this one.
void refuseKerfPictures(const scenario::Case& test_case);

}  // namespace kerfbench::live
