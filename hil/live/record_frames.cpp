// SPDX-License-Identifier: Apache-2.0
#include "hil/live/record_frames.h"

#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "hil/base/console.h"
#include "hil/inspect/verdict/verdict.h"
#include "hil/live/spot_recorder.h"
#include "hil/run/release.h"

namespace kerfbench::live {
namespace {

namespace fs = std::filesystem;

/// Before the camera streams: see FrameRecordingWriter.
void requireOwnFolder(const fs::path& out) {
  if (!fs::exists(out)) return;
  if (!fs::is_directory(out))
    throw base::InputError(fmt::format("{}: is no folder, and the recording needs one", out.string()));
  if (!fs::is_empty(out))
    throw base::InputError(
        fmt::format("{}: is not empty; a recording needs a folder of its own", out.string()));
}

}  // namespace

int recordFramesOf(camera::VideoCalls& calls, const RecordFramesOptions& options) {
  base::Console console(options.quiet);
  const scenario::Case test_case =
      scenario::readCase(options.scenario, options.bin_dir.parent_path() / "firmware");
  if (!test_case.scenario.cameras.spot.is_real)
    throw base::InputError(fmt::format("{}: names no real spot camera (cameras.spot: {{source: v4l2, ...}})",
                                       options.scenario.string()));
  requireOwnFolder(options.out);
  const OpenSpotCamera open = openSpotCamera(test_case, calls);
  camera::FrameRecordingWriter writer(options.out, open.camera);
  camera::RecordOptions how = recordOptions(open);
  how.most_frames = options.frames;
  how.first_timeout_ms = static_cast<int>(std::lround(1e3 * options.wait_s));
  console.say(fmt::format("recording {} ({})", open.camera.device, open.camera.card));
  std::optional<std::int64_t> end_ns;
  const std::string ended = camera::recordFrames(*open.stream, writer, how, [&] {
    if (!end_ns && writer.frames() > 0)
      end_ns = calls.monotonicNs() + static_cast<std::int64_t>(1e9 * options.time_limit_s);
    return end_ns && calls.monotonicNs() >= *end_ns;
  });
  console.result(fmt::format("{} frames in {}{}", writer.frames(), options.out.string(),
                             ended.empty() ? "" : "; the camera ended: " + ended));
  const bool all_came = writer.frames() > 0 && (options.frames == 0 || writer.frames() == options.frames);
  return all_came ? 0 : inspect::exitCode(inspect::Verdict::kInvalid);
}

}  // namespace kerfbench::live
