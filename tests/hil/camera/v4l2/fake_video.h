// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hil/camera/v4l2/video_calls.h"

namespace kerfbench::camera {

/// Next frame of a FakeVideo's sensor.
struct FakeFrame {
  std::vector<std::uint8_t> bytes;
  std::uint32_t sequence{};
  std::int64_t stamp_ns{};
  std::uint32_t flags{V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC};
  std::int64_t arrival_ns{};           ///< Time at which the frame is there.
  std::int64_t bytesused{-1};          ///< Number of bytes used; -1: as many as `bytes`.
  std::function<void()> before{};      ///< Called as the frame arrives: something happens to the device.
  std::optional<timeval> odd_stamp{};  ///< Stamp that is reported instead of stamp_ns.
};

/// A video device in memory, with V4L2's states: REQBUFS, QUERYBUF, mmap, QBUF, STREAMON, DQBUF and back. It
/// refuses what the kernel refuses, and counts what was left open. Its time is its own.
class FakeVideo final : public VideoCalls {
 public:
  explicit FakeVideo(std::string path = "/dev/video7");
  ~FakeVideo() override;

  // State of the device, to be set up by a test.
  v4l2_pix_format format{};
  std::vector<v4l2_queryctrl> controls;
  std::map<std::uint32_t, std::int32_t> values;
  std::vector<std::uint32_t> fourccs{V4L2_PIX_FMT_GREY};
  std::vector<v4l2_frmsize_discrete> sizes{{64, 48}};
  bool has_stepwise_sizes{};
  v4l2_fract interval{1, 100};
  std::uint32_t can_set_interval{V4L2_CAP_TIMEPERFRAME};
  std::uint32_t caps{V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING};
  bool is_capability_per_device{true};
  std::uint32_t most_buffers{32};
  std::int32_t value_step{1};  ///< Step to which values of controls are rounded down.
  bool has_events{true};
  std::uint32_t input{};       ///< Selected input; events of changes of the source belong to it.
  std::size_t buffer_slack{};  ///< Excess of a buffer's bytes over a frame's.
  /// Rows and columns that the sensor has and reads out; absent: the driver knows no windows.
  std::optional<v4l2_rect> sensor{}, window{};
  int window_step{1};         ///< Step to which a window's place is rounded down.
  bool is_stubborn_format{};  ///< True if S_FMT leaves everything as it is.
  std::deque<FakeFrame> frames;
  std::deque<v4l2_event> events;
  std::int64_t now_ns{5'000'000'000};
  std::uint32_t given_index{UINT32_MAX};  ///< Index that DQBUF reports instead of the buffer's own.
  short idle_poll{};                      ///< Result of poll while nothing is there.

  /// Makes the n-th call of a request (0: the next one) fail with this errno from now on; with `forever` all
  /// after.
  void failIoctl(unsigned long request, int error, int after = 0, bool forever = true);
  int open_error{}, mmap_error{}, poll_error{};
  int mmap_fails_after{};  ///< Number of calls of mmap that succeed before one fails.
  int interruptions{};     ///< Number of calls of ioctl and poll that are interrupted first.
  bool is_gone{};

  void addControl(std::uint32_t id, const std::string& name, int min, int max, int value,
                  std::uint32_t flags = 0, std::uint32_t type = V4L2_CTRL_TYPE_INTEGER);
  /// Adds `count` grey frames that differ, at the device's interval, each arriving 1 ms after its stamp.
  void addFrames(int count, std::uint32_t first_sequence = 0);
  [[nodiscard]] FakeFrame frameOf(std::uint32_t sequence) const;

  [[nodiscard]] bool isStreaming() const { return is_streaming_; }
  [[nodiscard]] int openCount() const { return open_count_; }
  [[nodiscard]] std::size_t mappedCount() const { return mapped_.size(); }
  [[nodiscard]] std::size_t bufferCount() const { return buffers_.size(); }
  [[nodiscard]] std::size_t queuedCount() const { return queue_.size(); }
  [[nodiscard]] int count(unsigned long request) const;

  std::vector<std::string> nodes() override { return {path_}; }
  int open(const std::string& path) override;
  int close(int fd) override;
  int ioctl(int fd, unsigned long request, void* argument) override;
  void* mmap(std::size_t length, int fd, std::int64_t offset) override;
  int munmap(void* address, std::size_t length) override;
  int poll(int fd, short events_wanted, short* revents, int timeout_ms) override;
  std::int64_t monotonicNs() override { return now_ns; }

 private:
  struct Failure {
    int error{};
    int after{};
    bool forever{};
  };
  struct Buffer {
    std::vector<std::uint8_t> memory;
    bool is_mapped{};
    bool is_queued{};
  };
  int answer(unsigned long request, void* argument);
  int answerQuery(unsigned long request, void* argument);
  int answerControl(unsigned long request, void* argument);
  int setFormat(v4l2_format& wanted);
  int requestBuffers(v4l2_requestbuffers& wanted);
  int queryBuffer(v4l2_buffer& buffer);
  int queue(v4l2_buffer& buffer);
  int dequeue(v4l2_buffer& buffer);
  int start();
  int stop();
  int enumerate(unsigned long request, void* argument);
  bool isReady();
  [[nodiscard]] const v4l2_queryctrl* findControl(std::uint32_t id) const;

  std::string path_;
  std::vector<Buffer> buffers_;
  std::deque<std::uint32_t> queue_;
  std::set<void*> mapped_;
  std::map<unsigned long, Failure> failures_;
  std::map<unsigned long, int> counts_;
  bool is_streaming_{};
  bool is_subscribed_{};
  int open_count_{};
};

}  // namespace kerfbench::camera
