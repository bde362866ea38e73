// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/frame_watch.h"

#include <array>

namespace kerfbench::camera {
namespace {

using enum FrameFault;

}  // namespace

std::string_view nameOf(FrameFault fault) {
  constexpr std::array<std::string_view, 10> kNames{
      "the driver marks it as damaged",
      "it has too few or too many bytes",
      "it cannot be read",
      "its number is that of the frame before",
      "its picture is the one before, to the byte",
      "its number is smaller than that of the frame before",
      "its stamp is not later than that of the frame before",
      "its stamp lies in the future",
      "its stamp is too old",
      "frames are missing before it that the sequence does not show",
  };
  return kNames.at(static_cast<std::size_t>(fault));
}

bool FrameWatch::judgeSequence(const BufferNote& note, FrameIntegrity& frame) {
  constexpr std::uint32_t kHalf = 1U << 31U;
  // Modulo 2^32, as drivers count.
  const std::uint32_t steps = last_number_ ? note.sequence - *last_number_ : 0;
  const bool is_repeated = last_number_ && steps == 0;
  const bool is_back = steps >= kHalf;
  if (is_repeated) frame.faults.push_back(kRepeatedSequence);
  if (is_back) frame.faults.push_back(kSequenceBack);
  if (!is_repeated && !is_back) {
    frame.lost_before = last_number_ ? steps - 1 : 0;
    sequence_ += steps;
    last_number_ = note.sequence;
  }
  frame.sequence = sequence_;
  return !is_repeated && !is_back;
}

void FrameWatch::judgeStamp(const BufferNote& note, bool has_own_number, FrameIntegrity& frame) {
  const double ahead_s = static_cast<double>(note.stamp_ns - note.arrival_ns) * 1e-9;
  const bool is_ahead = ahead_s > options_.max_ahead_s;
  const bool is_stale = -ahead_s > options_.max_age_s;
  const bool is_back = last_stamped_ && note.stamp_ns <= last_stamped_->stamp_ns;
  if (is_ahead) frame.faults.push_back(kStampAhead);
  if (is_stale) frame.faults.push_back(kStampStale);
  if (is_back) frame.faults.push_back(kStampBack);
  // The next one is held against one that was believed.
  if (is_ahead || is_stale || is_back || !has_own_number) return;
  if (last_stamped_ && options_.period_s && frame.sequence > last_stamped_->sequence) {
    const auto steps = static_cast<double>(frame.sequence - last_stamped_->sequence);
    const double later_s = static_cast<double>(note.stamp_ns - last_stamped_->stamp_ns) * 1e-9;
    if (later_s > (steps + 0.5) * *options_.period_s) frame.faults.push_back(kStampGap);
  }
  last_stamped_ = {frame.sequence, note.stamp_ns};
}

FrameIntegrity FrameWatch::judge(const BufferNote& note, bool is_same_image, bool is_unreadable) {
  FrameIntegrity frame;
  const bool is_first = !last_number_;
  if (note.has_error) frame.faults.push_back(kErrorFlag);
  if (note.is_short) frame.faults.push_back(kShort);
  if (is_unreadable && !note.is_short) frame.faults.push_back(kUnreadable);
  if (is_same_image && options_.sensor_has_noise && !is_first) frame.faults.push_back(kRepeatedImage);
  const bool has_own_number = judgeSequence(note, frame);
  judgeStamp(note, has_own_number, frame);
  const bool is_whole = frame.isGood() && frame.lost_before == 0;
  frame.to_ns = note.stamp_ns;
  frame.from_ns = is_whole ? note.stamp_ns : last_good_ns_.value_or(note.stamp_ns);
  if (frame.isGood()) last_good_ns_ = note.stamp_ns;
  return frame;
}

}  // namespace kerfbench::camera
