// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace kerfbench::camera {

/// Clock of a driver's time stamps, as the driver declares it.
enum class StampClock {
  kUnknown,    ///< Not declared (v4l2loopback, though it is CLOCK_MONOTONIC there).
  kMonotonic,  ///< CLOCK_MONOTONIC.
  kCopied,     ///< The clock of whoever writes a loop device.
};

/// Driver's note on one buffer.
struct BufferNote {
  std::uint32_t sequence{};
  std::int64_t stamp_ns{};
  std::int64_t arrival_ns{};  ///< CLOCK_MONOTONIC, when the bench took it.
  StampClock clock{StampClock::kUnknown};
  bool is_start_of_exposure{};  ///< The stamp is the start of the exposure; false: the frame's end.
  bool has_error{};             ///< V4L2_BUF_FLAG_ERROR.
  bool is_short{};              ///< Fewer bytes than a frame has, or more than the driver says.
};

enum class FrameFault {
  kErrorFlag,
  kShort,
  kUnreadable,        ///< See decodeFrame().
  kRepeatedSequence,  ///< The number is that of the frame before.
  kRepeatedImage,     ///< Every byte as in the frame before, which a sensor's noise forbids.
  kSequenceBack,      ///< The number is smaller than that of the frame before.
  kStampBack,         ///< The stamp is not later than that of the frame before.
  kStampAhead,        ///< The stamp is later than its arrival by more than allowed.
  kStampStale,        ///< The stamp is earlier than its arrival by more than allowed.
  kStampGap,          ///< The stamp is later than the sequence says: frames lost without a number.
};
std::string_view nameOf(FrameFault fault);

struct FrameIntegrity {
  std::uint64_t sequence{};  ///< Number since the first frame, across the wrap at 2^32.
  std::vector<FrameFault> faults;
  std::uint64_t lost_before{};  ///< Numbers that are missing between this frame and the one before.
  /// Interval without trusted frames, from the last good frame's stamp to this one's. Empty where nothing is
  /// wrong.
  std::int64_t from_ns{}, to_ns{};

  [[nodiscard]] bool isGood() const { return faults.empty(); }
};

struct WatchOptions {
  std::optional<double>
      period_s{};  ///< Period of frames; absent where a trigger makes them: gaps in time say nothing.
  double max_ahead_s{0.1};  ///< vivid's stamps lie up to a frame in the future.
  double max_age_s{1.0};
  bool sensor_has_noise{true};  ///< False for test patterns and loops: equal pictures are no fault there.
};

/// Compares a driver's note on each frame with those before. It corrects nothing: it returns the faults, and
/// the caller leaves the frame out, so that it is missing in the sequence.
class FrameWatch {
 public:
  explicit FrameWatch(const WatchOptions& options) : options_(options) {}
  /// `is_same_image`: every byte as in the frame judged before. `is_unreadable`: of decodeFrame().
  FrameIntegrity judge(const BufferNote& note, bool is_same_image, bool is_unreadable);

 private:
  /// A stamp that was believed.
  struct Stamped {
    std::uint64_t sequence{};
    std::int64_t stamp_ns{};
  };
  /// False for a number that another frame has had.
  bool judgeSequence(const BufferNote& note, FrameIntegrity& frame);
  void judgeStamp(const BufferNote& note, bool has_own_number, FrameIntegrity& frame);

  WatchOptions options_;
  std::optional<std::uint32_t> last_number_;  ///< Driver's number of the last frame that had its own.
  std::uint64_t sequence_{};                  ///< Number of that frame since the first one.
  std::optional<Stamped> last_stamped_;
  std::optional<std::int64_t> last_good_ns_;
};

}  // namespace kerfbench::camera
