// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace kerfbench::camera {

/// What a driver says its time stamps are.
enum class StampClock {
  kUnknown,    ///< Not told (v4l2loopback, though it is CLOCK_MONOTONIC there).
  kMonotonic,  ///< CLOCK_MONOTONIC.
  kCopied,     ///< Whatever the writer of a loop gave.
};

/// What a driver says of one buffer.
struct BufferNote {
  std::uint32_t sequence{};
  std::int64_t stamp_ns{};
  std::int64_t arrival_ns{};  ///< CLOCK_MONOTONIC, when we took it.
  StampClock clock{StampClock::kUnknown};
  bool is_start_of_exposure{};  ///< What the stamp is the time of; else the frame's end.
  bool has_error{};             ///< V4L2_BUF_FLAG_ERROR.
  bool is_short{};              ///< Fewer bytes than a frame has, or more than the driver says.
};

enum class FrameFault {
  kErrorFlag,
  kShort,
  kUnreadable,        ///< See decodeFrame().
  kRepeatedSequence,  ///< The number of the frame before.
  kRepeatedImage,     ///< Every byte as in the frame before, which a sensor's noise forbids.
  kSequenceBack,      ///< A smaller number than the frame before.
  kStampBack,         ///< Not later than the frame before.
  kStampAhead,        ///< Later than its arrival by more than allowed.
  kStampStale,        ///< Earlier than its arrival by more than allowed.
  kStampGap,          ///< Later after the frame before than the sequence says: frames lost without a number.
};
std::string_view nameOf(FrameFault fault);

struct FrameIntegrity {
  std::uint64_t sequence{};  ///< Since the first frame, across the wrap at 2^32.
  std::vector<FrameFault> faults;
  std::uint64_t lost_before{};  ///< Numbers that are missing between this frame and the one before.
  /// Stamps between which frames were lost, or this one is not to be believed: of the last good frame and of
  /// this one. Equal where nothing is wrong.
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

/// Holds what a driver says of its frames against what it said before. Nothing that is wrong is mended:
/// faults are told, and the caller leaves the frame out, so that it is missing in the sequence.
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
  std::optional<std::uint32_t> last_number_;  ///< The driver's, of the last frame that had one of its own.
  std::uint64_t sequence_{};                  ///< Ours, of the same.
  std::optional<Stamped> last_stamped_;
  std::optional<std::int64_t> last_good_ns_;
};

}  // namespace kerfbench::camera
