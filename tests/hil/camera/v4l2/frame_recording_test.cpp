// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/frame_recording.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "fake_video.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/v4l2/frame_recorder.h"
#include "hil/camera/v4l2/v4l2_stream.h"

namespace kerfbench::camera {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using Kind = StreamEvent::Kind;

class FrameRecordings : public testing::Test {
 protected:
  FrameRecordings()
      : parent(fs::path(testing::TempDir()) /
               ("kerfbench_frames_" + std::to_string(::getpid()) + "_" +
                testing::UnitTest::GetInstance()->current_test_info()->name())),
        folder(parent / "spot") {
    fs::remove_all(parent);
  }
  ~FrameRecordings() override {
    std::error_code ignored;
    fs::remove_all(parent, ignored);
  }
  V4l2Stream& stream() {
    if (!stream_)
      stream_.emplace(video, "/dev/video7",
                      CameraSettings{.format = findPixelFormat("GREY"), .width_px = 64, .height_px = 48});
    return *stream_;
  }
  RecordedCamera camera() {
    return {"/dev/video7", "A \"camera\"\t\\", "fake", "memory:7", false, true, stream().setup()};
  }
  std::string record(const RecordOptions& options = {}) {
    FrameRecordingWriter writer(folder, camera());
    return recordFrames(stream(), writer, options, [] { return false; });
  }
  std::string contentOf(const char* name) const {
    std::ifstream file(folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void write(const char* name, const std::string& content) const {
    std::ofstream(folder / name, std::ios::binary) << content;
  }
  std::string whyNot() const {
    try {
      const FrameRecording recording(folder);
    } catch (const base::ConfigError& error) {
      return error.what();
    }
    return {};
  }

  FakeVideo video;
  const fs::path parent, folder;

 private:
  std::optional<V4l2Stream> stream_;
};

TEST_F(FrameRecordings, GiveEveryBufferAgainAsTheDriverGaveIt) {
  video.addFrames(6);
  for (FakeFrame& frame : video.frames) frame.sequence += 4'294'967'293U;  // The sequence number wraps.
  video.frames[2].flags = V4L2_BUF_FLAG_ERROR | V4L2_BUF_FLAG_TIMESTAMP_COPY;
  video.frames[3].bytesused = 100;
  video.frames[4].flags = V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const auto sent = video.frames;
  EXPECT_THAT(record(), HasSubstr("no frame within 1000 ms"));
  FrameRecording recording(folder);
  EXPECT_EQ(recording.frames(), 5U);  // The first is discarded.
  EXPECT_EQ(recording.camera().card, "A \"camera\"\t\\");
  EXPECT_EQ(recording.camera().device, "/dev/video7");
  EXPECT_EQ(recording.setup().layout.stride_bytes, 64U);
  EXPECT_EQ(recording.setup().frame_period_s, 0.01);
  EXPECT_THAT(recording.ended(), HasSubstr("no frame within"));
  EXPECT_EQ(recording.digest().size(), 64U);
  for (std::size_t i = 1; i < sent.size(); ++i) {
    const StreamEvent event = recording.next(0);
    ASSERT_EQ(event.kind, Kind::kFrame);
    EXPECT_EQ(event.note.sequence, sent[i].sequence);
    EXPECT_EQ(event.note.stamp_ns, sent[i].stamp_ns);
    EXPECT_EQ(event.note.arrival_ns, sent[i].arrival_ns);
    EXPECT_EQ(event.note.has_error, i == 2);
    EXPECT_EQ(event.note.is_short, i == 3);
    EXPECT_EQ(event.note.is_start_of_exposure, i == 4);
    EXPECT_EQ(event.note.clock, i == 2   ? StampClock::kCopied
                                : i == 4 ? StampClock::kUnknown
                                         : StampClock::kMonotonic);
    EXPECT_EQ(event.bytes.size(), i == 3 ? 100U : 64U * 48U);
    EXPECT_TRUE(std::ranges::equal(event.bytes, std::span(sent[i].bytes).first(event.bytes.size())));
  }
  for (int again = 0; again < 2; ++again) {
    const StreamEvent end = recording.next(0);
    EXPECT_EQ(end.kind, Kind::kEnd);
    EXPECT_THAT(end.words, HasSubstr("no frame within"));
  }
}

TEST_F(FrameRecordings, KnowWhichWindowTheyShow) {
  RecordedCamera one = camera();
  one.setup.layout.left_px = 300;
  one.setup.layout.top_px = 7;
  FrameRecordingWriter(folder, one).finish("");
  const FrameLayout layout = FrameRecording(folder).setup().layout;
  EXPECT_EQ(layout.left_px, 300);
  EXPECT_EQ(layout.top_px, 7);
}

TEST_F(FrameRecordings, KeepWhatTheCameraMadeOfItsSettings) {
  video.addFrames(2);
  RecordedCamera of = camera();
  of.is_triggered = true;
  of.sensor_has_noise = false;
  of.setup.outcomes = {{"exposure_s", 2e-4, 1.9e-4}, {"odd: key", 1, 2}};
  of.setup.exposure_s = 1.9e-4;
  of.setup.frame_period_s.reset();
  of.setup.layout.bits = 8;
  FrameRecordingWriter(folder, of).finish("");
  const FrameRecording recording(folder);
  EXPECT_TRUE(recording.camera().is_triggered);
  EXPECT_FALSE(recording.camera().sensor_has_noise);
  ASSERT_EQ(recording.setup().outcomes.size(), 2U);
  EXPECT_EQ(recording.setup().outcomes[1].setting, "odd: key");
  EXPECT_EQ(recording.setup().outcomes[0].got, 1.9e-4);
  EXPECT_EQ(recording.setup().exposure_s, 1.9e-4);
  EXPECT_FALSE(recording.setup().frame_period_s);
  EXPECT_EQ(recording.frames(), 0U);
}

TEST_F(FrameRecordings, AreUnfinishedUntilTheyAreWhole) {
  video.addFrames(4);
  EXPECT_THAT(whyNot(), HasSubstr("there is no recording of frames"));
  {
    FrameRecordingWriter writer(folder, camera());
    writer.add(stream().next(100));
    EXPECT_EQ(writer.frames(), 1U);
  }
  EXPECT_THAT(whyNot(), HasSubstr("was not finished"));
}

TEST_F(FrameRecordings, NeedAFolderOfTheirOwn) {
  fs::create_directories(folder);
  write("other", "x");
  EXPECT_THROW(FrameRecordingWriter(folder, camera()), std::invalid_argument);
  EXPECT_EQ(contentOf("other"), "x");
}

TEST_F(FrameRecordings, ThatWereChangedAreNotRead) {
  video.addFrames(5);
  (void)record();
  const std::string index = contentOf("frames.csv");
  const std::string raw = contentOf("frames.raw");
  const std::string camera_yaml = contentOf("camera.yaml");
  write("frames.csv", index + "\n");
  EXPECT_THAT(whyNot(), HasSubstr("frames.csv: was changed since"));
  write("frames.csv", index);
  write("frames.raw", raw.substr(1));
  EXPECT_THAT(whyNot(), HasSubstr("frames.raw: has 12287 bytes, and frames.csv has 12288"));
  fs::remove(folder / "frames.raw");
  EXPECT_THAT(whyNot(), HasSubstr("frames.raw: no such file"));
  write("camera.yaml", camera_yaml + "colour: red\n");
  write("frames.raw", raw);
  EXPECT_THAT(whyNot(), HasSubstr("colour"));
  write("camera.yaml", camera_yaml);
  EXPECT_EQ(whyNot(), "");
  // The damaged byte is in the third frame.
  std::string spoilt = raw;
  spoilt[2 * 64 * 48 + 5] ^= 1;
  write("frames.raw", spoilt);
  FrameRecording recording(folder);
  EXPECT_EQ(recording.next(0).kind, Kind::kFrame);
  EXPECT_EQ(recording.next(0).kind, Kind::kFrame);
  const StreamEvent broken = recording.next(0);
  EXPECT_EQ(broken.kind, Kind::kFailed);
  EXPECT_THAT(broken.words, HasSubstr("frame 2 was changed since"));
}

TEST_F(FrameRecordings, WhoseFilesSayWhatCannotBeAreNotRead) {
  video.addFrames(3);
  (void)record();
  const std::string camera_yaml = contentOf("camera.yaml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = camera_yaml;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    write("camera.yaml", text.replace(at, from.size(), to));
    return whyNot();
  };
  EXPECT_THAT(with("version: 1", "version: 2"),
              HasSubstr("camera.yaml:2: version: this program reads version 1"));
  EXPECT_THAT(with("format: GREY", "format: GRAY"), HasSubstr("format: 'GRAY' cannot be read"));
  EXPECT_THAT(with("bits: 8", "bits: 99"), HasSubstr("bits"));
  EXPECT_THAT(with("frames: 2", "frames: 3"), HasSubstr("frames.csv: has 2 frames, and camera.yaml says 3"));
}

TEST_F(FrameRecordings, EndWhenTheyAreAskedToOrFullOrTheCameraIsGone) {
  video.addFrames(10);
  {
    FrameRecordingWriter writer(parent / "asked", camera());
    int asked = 0;
    EXPECT_EQ(recordFrames(stream(), writer, {}, [&] { return ++asked > 4; }), "");
    EXPECT_EQ(writer.frames(), 3U);  // One more frame was discarded.
  }
  {
    FrameRecordingWriter writer(parent / "full", camera());
    EXPECT_EQ(recordFrames(stream(), writer, {.discard = 0, .most_frames = 2}, [] { return false; }), "");
    EXPECT_EQ(writer.frames(), 2U);
  }
  video.frames[1].before = [this] { video.is_gone = true; };
  FrameRecordingWriter writer(parent / "gone", camera());
  EXPECT_THAT(recordFrames(stream(), writer, {.discard = 0}, [] { return false; }), HasSubstr("vanished"));
  EXPECT_THAT(FrameRecording(parent / "gone").ended(), HasSubstr("vanished"));
}

TEST_F(FrameRecordings, WaitLongerForTheFirstFrameIfTold) {
  video.addFrames(3);
  for (FakeFrame& frame : video.frames) frame.arrival_ns += 3'000'000'000;
  for (FakeFrame& frame : video.frames) frame.stamp_ns += 3'000'000'000;
  EXPECT_THAT(record({.first_timeout_ms = 5000}), HasSubstr("no frame within 1000 ms"));
  EXPECT_EQ(FrameRecording(folder).frames(), 2U);
}

}  // namespace
}  // namespace kerfbench::camera
