// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/frame_recorder.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

namespace kerfbench::camera {

std::string recordFrames(BufferStream& stream, FrameRecordingWriter& writer, const RecordOptions& options,
                         const std::function<bool()>& stop) {
  constexpr int kAskEvery_ms = 50;
  std::uint64_t discarded = 0;
  int silent_ms = 0;
  std::string ended;
  while (!stop() && ended.empty() && (options.most_frames == 0 || writer.frames() < options.most_frames)) {
    const bool is_first = discarded == 0 && writer.frames() == 0;
    const int patience_ms = is_first ? options.first_timeout_ms : options.timeout_ms;
    const int wait_ms = std::min(kAskEvery_ms, patience_ms - silent_ms);
    const StreamEvent event = stream.next(wait_ms);
    if (event.kind == StreamEvent::Kind::kTimeout) {
      silent_ms += wait_ms;
      if (silent_ms >= patience_ms) ended = fmt::format("no frame within {} ms", patience_ms);
    } else if (event.kind != StreamEvent::Kind::kFrame) {
      ended = event.words;
    } else {
      silent_ms = 0;
      if (discarded < options.discard) {
        ++discarded;
      } else {
        writer.add(event);
      }
    }
  }
  writer.finish(ended);
  return ended;
}

}  // namespace kerfbench::camera
