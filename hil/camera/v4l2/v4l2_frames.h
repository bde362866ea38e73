// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hil/camera/frame_source.h"
#include "hil/camera/v4l2/buffer_stream.h"
#include "hil/camera/v4l2/camera_clock.h"
#include "hil/camera/v4l2/frame_watch.h"

namespace kerfbench::camera {

/// Something that went wrong, with the time on the clock of the pins in which pictures are missing for it.
struct CaptureIncident {
  double from_s{};  ///< Stamp of the last good frame before.
  double to_s{};
  std::uint64_t sequence{};
  std::string words;
};

struct CaptureReport {
  std::uint64_t taken{};                   ///< Frames that came, without those discarded at the start.
  std::uint64_t good{};                    ///< Frames among them that are good, and given out.
  std::uint64_t lost{};                    ///< Missing in the driver's sequence.
  double worst_ahead_s{};                  ///< Largest time of a stamp after its frame's arrival; 0 for none.
  StampClock clock{StampClock::kUnknown};  ///< Clock of the last frame.
  std::uint64_t incidents{};               ///< All of them.
  std::vector<CaptureIncident> first_incidents;  ///< The first 1000.
  std::string ended_early;  ///< Reason why fewer frames came than were asked for; empty if they all came.
};

struct V4l2FrameOptions {
  double exposure_s{};     ///< Time of the camera's shutter, or of the strobe where that is shorter; > 0.
  std::uint64_t frames{};  ///< Number of frames that are taken, good or not; > 0.
  int timeout_ms{1000};    ///< Time without a frame after which the camera has stopped; > 0.
  /// Frames left out at the start: the first buffer of a loopback holds an old picture.
  std::uint64_t discard{1};
  /// Watch of the frames; without a period it takes the driver's, unless is_triggered.
  WatchOptions watch{};
  bool is_triggered{};
};

/// Frames of a real camera. A frame that is not to be believed is left out, so that it is missing in the
/// sequence like a lost one: what judges a run (INVALID around a cut) needs no further rule.
class V4l2FrameSource final : public FrameSource {
 public:
  /// `stream` must outlive this. @throws std::invalid_argument that names every option out of range.
  V4l2FrameSource(BufferStream& stream, CameraClock clock, const V4l2FrameOptions& options);

  std::vector<Frame> nextBatch(std::size_t max) override;
  [[nodiscard]] const CaptureReport& report() const { return report_; }

 private:
  void take(const StreamEvent& event, std::vector<Frame>& frames);
  void tell(const FrameIntegrity& integrity, const std::string& why_unreadable);
  void tell(CaptureIncident incident);
  [[nodiscard]] double begin_s(std::int64_t stamp_ns) const;

  BufferStream& stream_;
  CameraClock clock_;
  V4l2FrameOptions options_;
  FrameWatch watch_;
  CaptureReport report_;
  std::vector<std::uint8_t> last_bytes_;
  std::uint64_t discarded_{};
};

}  // namespace kerfbench::camera
