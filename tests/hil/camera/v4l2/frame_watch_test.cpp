// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/frame_watch.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::camera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using enum FrameFault;

constexpr std::int64_t kMs = 1'000'000;

BufferNote noteAt(std::uint32_t sequence, std::int64_t stamp_ms) {
  BufferNote note;
  note.sequence = sequence;
  note.stamp_ns = stamp_ms * kMs;
  note.arrival_ns = note.stamp_ns + kMs;
  note.clock = StampClock::kMonotonic;
  return note;
}

FrameWatch watchOf10Ms() { return FrameWatch(WatchOptions{.period_s = 0.010}); }

TEST(FrameWatch, FindsNothingWrongWithGoodFrames) {
  FrameWatch watch = watchOf10Ms();
  for (std::uint32_t i = 0; i < 20; ++i) {
    const FrameIntegrity frame = watch.judge(noteAt(700 + i, 1000 + 10 * i), false, false);
    EXPECT_THAT(frame.faults, IsEmpty());
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.lost_before, 0U);
    EXPECT_EQ(frame.from_ns, frame.to_ns);
  }
}

TEST(FrameWatch, TellsHowManyWereLostAndWhen) {
  FrameWatch watch = watchOf10Ms();
  (void)watch.judge(noteAt(5, 1000), false, false);
  const FrameIntegrity frame = watch.judge(noteAt(9, 1040), false, false);
  EXPECT_THAT(frame.faults, IsEmpty());  // The frame itself is good.
  EXPECT_EQ(frame.lost_before, 3U);
  EXPECT_EQ(frame.sequence, 4U);
  EXPECT_EQ(frame.from_ns, 1000 * kMs);
  EXPECT_EQ(frame.to_ns, 1040 * kMs);
}

TEST(FrameWatch, CountsOnAcrossTheWrapOfTheSequence) {
  FrameWatch watch = watchOf10Ms();
  (void)watch.judge(noteAt(0xfffffffeU, 1000), false, false);
  EXPECT_EQ(watch.judge(noteAt(0xffffffffU, 1010), false, false).sequence, 1U);
  const FrameIntegrity frame = watch.judge(noteAt(1, 1030), false, false);
  EXPECT_EQ(frame.sequence, 3U);
  EXPECT_EQ(frame.lost_before, 1U);
}

TEST(FrameWatch, TellsARepeatedAndABackwardSequenceAndGoesOnFromTheLastGoodOne) {
  FrameWatch watch = watchOf10Ms();
  (void)watch.judge(noteAt(5, 1000), false, false);
  EXPECT_THAT(watch.judge(noteAt(5, 1010), false, false).faults, ElementsAre(kRepeatedSequence));
  EXPECT_THAT(watch.judge(noteAt(3, 1015), false, false).faults, ElementsAre(kSequenceBack));
  const FrameIntegrity frame = watch.judge(noteAt(6, 1010), false, false);
  EXPECT_TRUE(frame.isGood());
  EXPECT_EQ(frame.sequence, 1U);
}

TEST(FrameWatch, TellsLossesThatTheSequenceHidesByTheTime) {
  FrameWatch watch = watchOf10Ms();
  (void)watch.judge(noteAt(0, 1000), false, false);
  EXPECT_TRUE(watch.judge(noteAt(1, 1014), false, false).isGood());  // Jitter.
  const FrameIntegrity frame = watch.judge(noteAt(2, 1034), false, false);
  EXPECT_THAT(frame.faults, ElementsAre(kStampGap));
  EXPECT_EQ(frame.from_ns, 1014 * kMs);
  FrameWatch triggered{WatchOptions{}};
  (void)triggered.judge(noteAt(0, 1000), false, false);
  EXPECT_TRUE(triggered.judge(noteAt(1, 1500), false, false).isGood());
}

TEST(FrameWatch, TellsStampsThatRunBackAreTooOldOrInTheFuture) {
  FrameWatch watch = watchOf10Ms();
  (void)watch.judge(noteAt(0, 1000), false, false);
  EXPECT_THAT(watch.judge(noteAt(1, 1000), false, false).faults, ElementsAre(kStampBack));
  BufferNote ahead = noteAt(2, 1020);
  ahead.arrival_ns = 1000 * kMs;  // Vivid stamps frames like this; it is allowed.
  EXPECT_TRUE(watch.judge(ahead, false, false).isGood());
  ahead = noteAt(3, 1030);
  ahead.arrival_ns = 900 * kMs;
  EXPECT_THAT(watch.judge(ahead, false, false).faults, ElementsAre(kStampAhead));
  BufferNote stale = noteAt(4, 1040);
  stale.arrival_ns = 2100 * kMs;
  EXPECT_THAT(watch.judge(stale, false, false).faults, ElementsAre(kStampStale));
}

TEST(FrameWatch, TellsDamageShortnessAndRepetition) {
  FrameWatch watch = watchOf10Ms();
  BufferNote note = noteAt(0, 1000);
  note.has_error = true;
  EXPECT_THAT(watch.judge(note, false, false).faults, ElementsAre(kErrorFlag));
  note = noteAt(1, 1010);
  note.is_short = true;
  EXPECT_THAT(watch.judge(note, false, true).faults, ElementsAre(kShort));
  EXPECT_THAT(watch.judge(noteAt(2, 1020), false, true).faults, ElementsAre(kUnreadable));
  const FrameIntegrity repeated = watch.judge(noteAt(3, 1030), true, false);
  EXPECT_THAT(repeated.faults, ElementsAre(kRepeatedImage));
  EXPECT_EQ(repeated.sequence, 3U);
  EXPECT_TRUE(watch.judge(noteAt(4, 1040), false, false).isGood());
}

TEST(FrameWatch, TakesEqualPicturesOfASensorWithoutNoise) {
  FrameWatch watch(WatchOptions{.period_s = 0.010, .sensor_has_noise = false});
  (void)watch.judge(noteAt(0, 1000), false, false);
  EXPECT_TRUE(watch.judge(noteAt(1, 1010), true, false).isGood());
}

TEST(FrameWatch, BeginsItsSpanWithTheLastGoodFrame) {
  FrameWatch watch = watchOf10Ms();
  (void)watch.judge(noteAt(0, 1000), false, false);
  for (std::uint32_t i = 1; i < 4; ++i) {
    BufferNote bad = noteAt(i, 1000 + 10 * i);
    bad.has_error = true;
    EXPECT_EQ(watch.judge(bad, false, false).from_ns, 1000 * kMs);
  }
  EXPECT_EQ(watch.judge(noteAt(5, 1050), false, false).from_ns, 1000 * kMs);
}

TEST(FrameFaults, HaveEachWordsOfTheirOwn) {
  std::set<std::string_view> names;
  for (const FrameFault fault : {kErrorFlag, kShort, kUnreadable, kRepeatedSequence, kRepeatedImage,
                                 kSequenceBack, kStampBack, kStampAhead, kStampStale, kStampGap})
    names.insert(nameOf(fault));
  EXPECT_EQ(names.size(), 10U);
}

}  // namespace
}  // namespace kerfbench::camera
