// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/v4l2_stream.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_video.h"

namespace kerfbench::camera {
namespace {

using testing::HasSubstr;
using Kind = StreamEvent::Kind;

constexpr const char* kPath = "/dev/video7";

CameraSettings streamSettings() {
  return {.format = findPixelFormat("GREY"), .width_px = 64, .height_px = 48};
}

/// Expects an event that ends the stream: it is reported again.
void expectEnds(V4l2Stream& stream, Kind kind, const std::string& words) {
  for (int i = 0; i < 2; ++i) {
    const StreamEvent event = stream.next(1000);
    EXPECT_EQ(event.kind, kind) << event.words;
    EXPECT_THAT(event.words, HasSubstr(words));
    EXPECT_THAT(event.words, HasSubstr(kPath));
  }
}

/// A device with which each poll takes 10 ms.
class Ticking final : public VideoCalls {
 public:
  explicit Ticking(FakeVideo& video) : video_(video) {}
  int polls{};

  std::vector<std::string> nodes() override { return video_.nodes(); }
  int open(const std::string& path) override { return video_.open(path); }
  int close(int fd) override { return video_.close(fd); }
  int ioctl(int fd, unsigned long request, void* argument) override {
    return video_.ioctl(fd, request, argument);
  }
  void* mmap(std::size_t length, int fd, std::int64_t offset) override {
    return video_.mmap(length, fd, offset);
  }
  int munmap(void* address, std::size_t length) override { return video_.munmap(address, length); }
  int poll(int fd, short events, short* revents, int timeout_ms) override {
    ++polls;
    video_.now_ns += 10'000'000;
    return video_.poll(fd, events, revents, timeout_ms);
  }
  std::int64_t monotonicNs() override { return video_.monotonicNs(); }

 private:
  FakeVideo& video_;
};

TEST(V4l2Stream, GivesFramesInOrderWithWhatTheDriverSaysOfThem) {
  FakeVideo video;
  video.addFrames(40, 90);
  video.frames[1].flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  video.frames[2].flags = V4L2_BUF_FLAG_TIMESTAMP_COPY | V4L2_BUF_FLAG_ERROR;
  video.frames[3].flags = 0;
  {
    V4l2Stream stream(video, kPath, streamSettings(), 4);
    EXPECT_EQ(video.bufferCount(), 4U);
    EXPECT_EQ(video.queuedCount(), 4U);
    for (std::uint32_t i = 0; i < 40; ++i) {
      const FakeFrame sent = video.frames.front();
      const StreamEvent event = stream.next(1000);
      ASSERT_EQ(event.kind, Kind::kFrame) << event.words;
      EXPECT_EQ(event.note.sequence, 90 + i);
      EXPECT_EQ(event.note.stamp_ns, sent.stamp_ns);
      EXPECT_EQ(event.note.arrival_ns, sent.arrival_ns);
      EXPECT_EQ(event.note.is_start_of_exposure, i == 1);
      EXPECT_EQ(event.note.has_error, i == 2);
      EXPECT_FALSE(event.note.is_short);
      EXPECT_EQ(event.note.clock, i == 2   ? StampClock::kCopied
                                  : i == 3 ? StampClock::kUnknown
                                           : StampClock::kMonotonic);
      EXPECT_TRUE(std::ranges::equal(event.bytes, sent.bytes));
      EXPECT_EQ(video.queuedCount(), 3U);  // All buffers are queued but the one under test.
    }
  }
  EXPECT_FALSE(video.isStreaming());
  EXPECT_EQ(video.bufferCount(), 0U);
}

TEST(V4l2Stream, MakesATimeOfAStampThatIsNone) {
  FakeVideo video;
  video.addFrames(3);
  constexpr auto kFar = std::numeric_limits<decltype(timeval::tv_sec)>::max();
  video.frames[0].odd_stamp = timeval{kFar, kFar};
  video.frames[1].odd_stamp = timeval{-kFar, -kFar};
  video.frames[2].odd_stamp = timeval{7, 1'000'000};
  V4l2Stream stream(video, kPath, streamSettings());
  EXPECT_EQ(stream.next(1000).note.stamp_ns, 4'000'000'000'999'999'000);
  EXPECT_EQ(stream.next(1000).note.stamp_ns, 0);
  EXPECT_EQ(stream.next(1000).note.stamp_ns, 7'999'999'000);
}

TEST(V4l2Stream, SaysThatNothingCameAndGoesOnWhenItDoes) {
  FakeVideo video;
  V4l2Stream stream(video, kPath, streamSettings());
  const StreamEvent none = stream.next(250);
  EXPECT_EQ(none.kind, Kind::kTimeout);
  EXPECT_THAT(none.words, HasSubstr("no frame within 250 ms"));
  EXPECT_EQ(video.now_ns, 5'250'000'000);
  video.addFrames(1, 200);
  EXPECT_EQ(stream.next(10'000).kind, Kind::kFrame);
}

TEST(V4l2Stream, IsNotKeptWaitingByWakeUpsForNothing) {
  FakeVideo video;
  video.idle_poll = POLLIN;  // Another thread took the frame, for example; DQBUF gives EAGAIN.
  Ticking ticking(video);
  V4l2Stream stream(ticking, kPath, streamSettings());
  EXPECT_EQ(stream.next(100).kind, Kind::kTimeout);
  EXPECT_EQ(ticking.polls, 11);
}

TEST(V4l2Stream, MakesAnInterruptedCallAgain) {
  FakeVideo video;
  video.addFrames(2);
  video.interruptions = 5;
  V4l2Stream stream(video, kPath, streamSettings());
  video.interruptions = 3;
  EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
  video.interruptions = 3;
  EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
}

TEST(V4l2Stream, TellsFramesOfTooFewOrTooManyBytesAndReadsNoneBeyondTheBuffer) {
  FakeVideo video;
  video.addFrames(3);
  video.frames[0].bytesused = 64 * 48 - 1;
  video.frames[1].bytesused = 64 * 48 + 1;
  V4l2Stream stream(video, kPath, streamSettings());
  StreamEvent event = stream.next(1000);
  EXPECT_TRUE(event.note.is_short);
  EXPECT_EQ(event.bytes.size(), 64U * 48 - 1);
  event = stream.next(1000);
  EXPECT_TRUE(event.note.is_short);
  EXPECT_EQ(event.bytes.size(), 64U * 48);
  EXPECT_FALSE(stream.next(1000).note.is_short);
}

// The buffers of v4l2loopback are whole pages, and a writer of larger pictures fills them.
TEST(V4l2Stream, TellsAFrameThatIsLongerThanFramesAreThoughTheBufferHoldsIt) {
  FakeVideo video;
  video.buffer_slack = 1024;
  video.addFrames(2);
  video.frames[0].bytesused = 64 * 48 + 1;
  V4l2Stream stream(video, kPath, streamSettings());
  EXPECT_TRUE(stream.next(1000).note.is_short);
  EXPECT_FALSE(stream.next(1000).note.is_short);
}

TEST(V4l2Stream, HearsOfTheSourceOfTheInputThatIsSelected) {
  FakeVideo video;
  video.input = 2;
  video.addFrames(2);
  V4l2Stream stream(video, kPath, streamSettings());
  EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
  v4l2_event change{};
  change.type = V4L2_EVENT_SOURCE_CHANGE;
  change.id = 2;
  change.u.src_change.changes = V4L2_EVENT_SRC_CH_RESOLUTION;
  video.events = {change};
  expectEnds(stream, Kind::kSizeChanged, "the source changed its size");
}

TEST(V4l2Stream, EndsWhenTheSourceTellsAnotherSize) {
  FakeVideo video;
  video.addFrames(3);
  V4l2Stream stream(video, kPath, streamSettings());
  EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
  v4l2_event other{};
  other.type = V4L2_EVENT_CTRL;
  video.events.push_back(other);
  EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
  v4l2_event change{};
  change.type = V4L2_EVENT_SOURCE_CHANGE;
  change.u.src_change.changes = V4L2_EVENT_SRC_CH_RESOLUTION;
  video.events = {other, change};
  expectEnds(stream, Kind::kSizeChanged, "the source changed its size");
}

TEST(V4l2Stream, EndsWhenSizeFormatOrRowsAreOthersWithoutAWord) {
  for (const int what : {0, 1, 2, 3}) {
    FakeVideo video;
    video.has_events = false;
    video.addFrames(3);
    V4l2Stream stream(video, kPath, streamSettings());
    EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
    if (what == 0) video.format.width = 128;
    if (what == 1) video.format.height = 24;
    if (what == 2) video.format.pixelformat = V4L2_PIX_FMT_SRGGB8;
    if (what == 3) video.format.bytesperline = 128;
    expectEnds(stream, Kind::kSizeChanged, "became");
  }
}

TEST(V4l2Stream, EndsWhenTheCameraVanishesWhereverThatIs) {
  for (const bool before_poll : {true, false}) {
    FakeVideo video;
    video.addFrames(3);
    V4l2Stream stream(video, kPath, streamSettings());
    EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
    if (before_poll)
      video.is_gone = true;
    else
      video.frames.front().before = [&] { video.is_gone = true; };
    expectEnds(stream, Kind::kGone, "has vanished");
  }
  FakeVideo video;  // Nothing is given back yet: the very first frame.
  video.addFrames(1);
  V4l2Stream stream(video, kPath, streamSettings());
  video.is_gone = true;
  expectEnds(stream, Kind::kGone, "has vanished");
}

TEST(V4l2Stream, EndsByEveryFailureWithTheCallsName) {
  struct Case {
    unsigned long request;
    const char* name;
  };
  for (const auto& [request, name] : {Case{VIDIOC_DQBUF, "VIDIOC_DQBUF: Input/output error"},
                                      Case{VIDIOC_QBUF, "VIDIOC_QBUF: Input/output error"},
                                      Case{VIDIOC_G_FMT, "VIDIOC_G_FMT: Input/output error"}}) {
    FakeVideo video;
    video.addFrames(3);
    V4l2Stream stream(video, kPath, streamSettings());
    EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
    video.failIoctl(request, EIO);
    expectEnds(stream, Kind::kFailed, name);
  }
  FakeVideo video;
  V4l2Stream stream(video, kPath, streamSettings());
  video.poll_error = ENOMEM;
  expectEnds(stream, Kind::kFailed, "poll: ");
}

TEST(V4l2Stream, EndsWhenPollTellsOfAnErrorThatDqbufDoesNotName) {
  FakeVideo video;
  V4l2Stream stream(video, kPath, streamSettings());
  video.idle_poll = POLLERR;
  expectEnds(stream, Kind::kFailed, "without a name");
}

TEST(V4l2Stream, BelievesNoBufferThatIsNotThere) {
  FakeVideo video;
  video.addFrames(1);
  V4l2Stream stream(video, kPath, streamSettings(), 4);
  video.given_index = 4;
  expectEnds(stream, Kind::kFailed, "buffer 4 of 4");
}

TEST(V4l2Stream, TakesTheNumberOfBuffersThatTheDriverGivesIfItIsEnough) {
  FakeVideo video;
  video.most_buffers = 3;
  video.addFrames(10);
  V4l2Stream stream(video, kPath, streamSettings(), 8);
  EXPECT_EQ(video.mappedCount(), 3U);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(stream.next(1000).kind, Kind::kFrame);
}

/// Reason why a stream cannot be made; the device itself checks whether anything was left open or mapped.
std::string whyNot(FakeVideo& video, int buffers = 8) {
  try {
    const V4l2Stream stream(video, kPath, streamSettings(), buffers);
  } catch (const std::system_error& error) {
    return error.what();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "it streams";
}

TEST(V4l2Stream, IsNotMadeOfADeviceThatFailsOnTheWay) {
  struct Case {
    unsigned long request;
    int after;
    const char* name;
  };
  for (const auto& [request, after, name] :
       {Case{VIDIOC_QUERYCAP, 0, "VIDIOC_QUERYCAP"}, Case{VIDIOC_REQBUFS, 0, "VIDIOC_REQBUFS"},
        Case{VIDIOC_QUERYBUF, 0, "VIDIOC_QUERYBUF"}, Case{VIDIOC_QUERYBUF, 3, "VIDIOC_QUERYBUF"},
        Case{VIDIOC_QBUF, 0, "VIDIOC_QBUF"}, Case{VIDIOC_QBUF, 3, "VIDIOC_QBUF"},
        Case{VIDIOC_STREAMON, 0, "VIDIOC_STREAMON"}}) {
    FakeVideo video;
    video.failIoctl(request, EBUSY, after);
    EXPECT_THAT(whyNot(video), HasSubstr(std::string(kPath) + ": " + name));
  }
}

TEST(V4l2Stream, IsNotMadeWhereMemoryCannotBeMapped) {
  for (const int after : {0, 2}) {
    FakeVideo video;
    video.mmap_error = ENOMEM;
    video.mmap_fails_after = after;
    EXPECT_THAT(whyNot(video), HasSubstr("mmap: Cannot allocate memory"));
  }
}

TEST(V4l2Stream, IsNotMadeOfADeviceThatCannotBeOpened) {
  FakeVideo video;
  video.open_error = EACCES;
  EXPECT_THAT(whyNot(video), HasSubstr("/dev/video7: open: Permission denied"));
}

TEST(V4l2Stream, IsNotMadeOfWhatGivesNoPictures) {
  const std::vector<std::uint32_t> lacking{V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_STREAMING,
                                           V4L2_CAP_VIDEO_CAPTURE};
  for (const std::uint32_t caps : lacking) {
    FakeVideo video;
    video.caps = caps;
    EXPECT_THAT(whyNot(video), HasSubstr("no pictures"));
  }
}

TEST(V4l2Stream, IsNotMadeWithTooFewBuffers) {
  FakeVideo video;
  EXPECT_THAT(whyNot(video, 1), HasSubstr("buffers must be 2 ... 32"));
  EXPECT_THAT(whyNot(video, 33), HasSubstr("buffers must be"));
  video.most_buffers = 1;
  EXPECT_THAT(whyNot(video), HasSubstr("too few buffers"));
}

}  // namespace
}  // namespace kerfbench::camera
