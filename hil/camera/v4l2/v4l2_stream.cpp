// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/v4l2_stream.h"

#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace kerfbench::camera {
namespace {

using Kind = StreamEvent::Kind;

v4l2_buffer emptyBuffer(std::uint32_t index = 0) {
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  return buffer;
}

StampClock clockOf(std::uint32_t flags) {
  switch (flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) {
    case V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC:
      return StampClock::kMonotonic;
    case V4L2_BUF_FLAG_TIMESTAMP_COPY:
      return StampClock::kCopied;
    default:
      return StampClock::kUnknown;
  }
}

/// Stamp that is no time becomes the nearest that is one; FrameWatch reports it.
std::int64_t stampOf_ns(const timeval& stamp) {
  constexpr std::int64_t kMost_s = 4'000'000'000;  // The difference of two still has room in 64 bits.
  const std::int64_t whole_s = std::clamp(std::int64_t{stamp.tv_sec}, std::int64_t{0}, kMost_s);
  const std::int64_t rest_us =
      std::clamp(std::int64_t{stamp.tv_usec}, std::int64_t{0}, std::int64_t{999'999});
  return whole_s * 1'000'000'000 + rest_us * 1000;
}

BufferNote noteOf(const v4l2_buffer& buffer, std::int64_t arrival_ns) {
  BufferNote note;
  note.sequence = buffer.sequence;
  note.stamp_ns = stampOf_ns(buffer.timestamp);
  note.arrival_ns = arrival_ns;
  note.clock = clockOf(buffer.flags);
  note.is_start_of_exposure = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  note.has_error = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  return note;
}

}  // namespace

V4l2Stream::V4l2Stream(VideoCalls& calls, const std::string& path, const CameraSettings& settings,
                       int buffers)
    : device_(calls, path), settings_(settings) {
  requireCapture();
  setup_ = setUpCamera(device_, settings_);
  subscribe();
  try {
    mapBuffers(buffers);
    for (std::uint32_t i = 0; i < mappings_.size(); ++i) {
      v4l2_buffer buffer = emptyBuffer(i);
      device_.require(VIDIOC_QBUF, &buffer, "VIDIOC_QBUF");
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    device_.require(VIDIOC_STREAMON, &type, "VIDIOC_STREAMON");
  } catch (...) {
    releaseAll();
    throw;
  }
}

V4l2Stream::~V4l2Stream() { releaseAll(); }

void V4l2Stream::requireCapture() {
  v4l2_capability what{};
  device_.require(VIDIOC_QUERYCAP, &what, "VIDIOC_QUERYCAP");
  const std::uint32_t can =
      (what.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? what.device_caps : what.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0)
    throw std::invalid_argument(device_.path() + ": gives no pictures by streaming");
}

// Events of the source, which few drivers have; the layout is read in addition. They are those of one input,
// not of the device.
void V4l2Stream::subscribe() {
  int input = 0;
  (void)device_.request(VIDIOC_G_INPUT, &input);
  v4l2_event_subscription changes{};
  changes.type = V4L2_EVENT_SOURCE_CHANGE;
  changes.id = static_cast<std::uint32_t>(input);
  (void)device_.request(VIDIOC_SUBSCRIBE_EVENT, &changes);
}

void V4l2Stream::mapBuffers(int count) {
  constexpr int kLeast = 2;
  constexpr int kMost = 32;  // VIDEO_MAX_FRAME
  if (count < kLeast || count > kMost)
    throw std::invalid_argument(fmt::format("{}: buffers must be {} ... {}", device_.path(), kLeast, kMost));
  v4l2_requestbuffers wanted{};
  wanted.count = static_cast<std::uint32_t>(count);
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.memory = V4L2_MEMORY_MMAP;
  device_.require(VIDIOC_REQBUFS, &wanted, "VIDIOC_REQBUFS");
  if (wanted.count < kLeast) throwVideoError(ENOMEM, device_.path(), "VIDIOC_REQBUFS gives too few buffers");
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    v4l2_buffer buffer = emptyBuffer(i);
    device_.require(VIDIOC_QUERYBUF, &buffer, "VIDIOC_QUERYBUF");
    void* const address = device_.calls().mmap(buffer.length, device_.fd(), buffer.m.offset);
    if (address == nullptr) throwVideoError(errno, device_.path(), "mmap");
    mappings_.push_back({address, buffer.length});
  }
}

void V4l2Stream::releaseAll() noexcept {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  (void)device_.request(VIDIOC_STREAMOFF, &type);
  for (const Mapping& mapping : mappings_) (void)device_.calls().munmap(mapping.address, mapping.length);
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = V4L2_MEMORY_MMAP;
  (void)device_.request(VIDIOC_REQBUFS, &none);
}

StreamEvent V4l2Stream::end(Kind kind, std::string words) {
  ended_ = StreamEvent{kind, {}, {}, device_.path() + ": " + std::move(words)};
  return *ended_;
}

StreamEvent V4l2Stream::endBy(int error, const char* call) {
  if (error == ENODEV || error == ENXIO) return end(Kind::kGone, "the camera has vanished");
  return end(Kind::kFailed, fmt::format("{}: {}", call, std::strerror(error)));
}

bool V4l2Stream::giveBack(StreamEvent& ended) {
  if (!held_) return true;
  v4l2_buffer buffer = emptyBuffer(*std::exchange(held_, std::nullopt));
  const int error = device_.request(VIDIOC_QBUF, &buffer);
  if (error != 0) ended = endBy(error, "VIDIOC_QBUF");
  return error == 0;
}

bool V4l2Stream::sizeEvent() {
  for (v4l2_event event{}; device_.request(VIDIOC_DQEVENT, &event) == 0; event = {}) {
    if (event.type == V4L2_EVENT_SOURCE_CHANGE &&
        (event.u.src_change.changes & V4L2_EVENT_SRC_CH_RESOLUTION) != 0)
      return true;
    if (event.pending == 0) break;
  }
  return false;
}

std::optional<StreamEvent> V4l2Stream::checkLayout() {
  v4l2_format now{};
  now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int error = device_.request(VIDIOC_G_FMT, &now); error != 0) return endBy(error, "VIDIOC_G_FMT");
  const FrameLayout& layout = setup_.layout;
  const v4l2_pix_format& pix = now.fmt.pix;
  if (pix.pixelformat == layout.format->fourcc && static_cast<int>(pix.width) == layout.width_px &&
      static_cast<int>(pix.height) == layout.height_px && pix.bytesperline == layout.stride_bytes)
    return std::nullopt;
  return end(Kind::kSizeChanged, fmt::format("{} {} x {} became {} {} x {} while it streamed",
                                             layout.format->name, layout.width_px, layout.height_px,
                                             fourccText(pix.pixelformat), pix.width, pix.height));
}

std::optional<StreamEvent> V4l2Stream::take() {
  v4l2_buffer buffer = emptyBuffer();
  const int error = device_.request(VIDIOC_DQBUF, &buffer);
  if (error == EAGAIN) return std::nullopt;
  if (error != 0) return endBy(error, "VIDIOC_DQBUF");
  if (buffer.index >= mappings_.size())
    return end(Kind::kFailed,
               fmt::format("the driver gives buffer {} of {}", buffer.index, mappings_.size()));
  held_ = buffer.index;
  if (auto changed = checkLayout()) return changed;
  const Mapping& mapping = mappings_[buffer.index];
  StreamEvent frame;
  frame.note = noteOf(buffer, device_.calls().monotonicNs());
  // A buffer may be longer than a frame: v4l2loopback's are whole pages.
  const FrameLayout& layout = setup_.layout;
  const std::size_t most =
      layout.most_bytes == 0 ? mapping.length : std::min(layout.most_bytes, mapping.length);
  frame.note.is_short = buffer.bytesused < layout.leastBytes() || buffer.bytesused > most;
  frame.bytes = {static_cast<const std::uint8_t*>(mapping.address),
                 std::min<std::size_t>(buffer.bytesused, mapping.length)};
  return frame;
}

StreamEvent V4l2Stream::next(int timeout_ms) {
  if (ended_) return *ended_;
  StreamEvent ended;
  if (!giveBack(ended)) return ended;
  const std::int64_t deadline_ns = device_.calls().monotonicNs() + std::int64_t{timeout_ms} * 1'000'000;
  for (;;) {
    const std::int64_t left_ns = deadline_ns - device_.calls().monotonicNs();
    if (left_ns < 0) break;
    short what = 0;
    const int count = device_.calls().poll(device_.fd(), POLLIN | POLLPRI, &what,
                                           static_cast<int>((left_ns + 999'999) / 1'000'000));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return endBy(errno, "poll");
    if (count == 0) break;
    if ((what & POLLPRI) != 0 && sizeEvent())
      return end(Kind::kSizeChanged, "the source changed its size while it streamed");
    if ((what & (POLLIN | POLLERR | POLLHUP | POLLNVAL)) == 0) continue;
    if (auto event = take()) return *event;
    if ((what & POLLIN) == 0) return end(Kind::kFailed, "poll tells of a failure without a name");
  }
  return {Kind::kTimeout, {}, {}, fmt::format("{}: no frame within {} ms", device_.path(), timeout_ms)};
}

}  // namespace kerfbench::camera
