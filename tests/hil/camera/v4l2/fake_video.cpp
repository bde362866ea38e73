// SPDX-License-Identifier: Apache-2.0
#include "fake_video.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <gtest/gtest.h>

namespace kerfbench::camera {
namespace {

constexpr int kFd = 42;
constexpr std::int64_t kOffsetStep = 1 << 20;

template <std::size_t n>
void put(__u8 (&field)[n], const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), n - 1));
}

template <typename T>
T& as(void* argument) {
  return *static_cast<T*>(argument);
}

}  // namespace

FakeVideo::FakeVideo(std::string path) : path_(std::move(path)) {
  format.width = 64;
  format.height = 48;
  format.pixelformat = V4L2_PIX_FMT_GREY;
  format.bytesperline = 64;
  format.sizeimage = 64 * 48;
  format.field = V4L2_FIELD_NONE;
}

FakeVideo::~FakeVideo() {
  EXPECT_EQ(open_count_, 0) << "left open";
  EXPECT_TRUE(mapped_.empty()) << "left mapped";
}

void FakeVideo::failIoctl(unsigned long request, int error, int after, bool forever) {
  failures_[request] = {error, after, forever};
}

void FakeVideo::addControl(std::uint32_t id, const std::string& name, int min, int max, int value,
                           std::uint32_t flags, std::uint32_t type) {
  v4l2_queryctrl control{};
  control.id = id;
  control.type = type;
  put(control.name, name);
  control.minimum = min;
  control.maximum = max;
  control.step = 1;
  control.default_value = value;
  control.flags = flags;
  controls.push_back(control);
  std::ranges::sort(controls, {}, &v4l2_queryctrl::id);
  values[id] = value;
}

FakeFrame FakeVideo::frameOf(std::uint32_t sequence) const {
  FakeFrame frame;
  frame.sequence = sequence;
  frame.bytes.assign(format.sizeimage, static_cast<std::uint8_t>(sequence % 251));
  const std::int64_t period_ns = 1'000'000'000LL * interval.numerator / interval.denominator;
  frame.stamp_ns = 5'000'000'000 + period_ns * (sequence + 1LL);
  frame.arrival_ns = frame.stamp_ns + 1'000'000;
  return frame;
}

void FakeVideo::addFrames(int count, std::uint32_t first_sequence) {
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i)
    frames.push_back(frameOf(first_sequence + i));
}

int FakeVideo::count(unsigned long request) const {
  const auto found = counts_.find(request);
  return found == counts_.end() ? 0 : found->second;
}

int FakeVideo::open(const std::string& path) {
  errno = is_gone || path != path_ ? ENOENT : open_error;
  if (errno != 0) return -1;
  ++open_count_;
  return kFd;
}

int FakeVideo::close(int fd) {
  EXPECT_EQ(fd, kFd);
  EXPECT_GT(open_count_--, 0) << "closed twice";
  is_streaming_ = false;
  return 0;
}

int FakeVideo::ioctl(int fd, unsigned long request, void* argument) {
  EXPECT_EQ(fd, kFd);
  EXPECT_GT(open_count_, 0);
  if (interruptions > 0) {
    --interruptions;
    errno = EINTR;
    return -1;
  }
  ++counts_[request];
  int error = is_gone ? ENODEV : 0;
  if (const auto failure = failures_.find(request); error == 0 && failure != failures_.end()) {
    Failure& planned = failure->second;
    if (planned.after-- <= 0) {
      error = planned.error;
      if (!planned.forever) failures_.erase(failure);
    }
  }
  if (error == 0) error = answer(request, argument);
  errno = error;
  return error == 0 ? 0 : -1;
}

int FakeVideo::answer(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_S_FMT:
      return setFormat(as<v4l2_format>(argument));
    case VIDIOC_REQBUFS:
      return requestBuffers(as<v4l2_requestbuffers>(argument));
    case VIDIOC_QUERYBUF:
      return queryBuffer(as<v4l2_buffer>(argument));
    case VIDIOC_QBUF:
      return queue(as<v4l2_buffer>(argument));
    case VIDIOC_DQBUF:
      return dequeue(as<v4l2_buffer>(argument));
    case VIDIOC_STREAMON:
      return start();
    case VIDIOC_STREAMOFF:
      return stop();
    case VIDIOC_SUBSCRIBE_EVENT:
      is_subscribed_ = has_events && as<v4l2_event_subscription>(argument).id == input;
      return has_events ? 0 : ENOTTY;
    case VIDIOC_DQEVENT:
      if (events.empty()) return ENOENT;
      as<v4l2_event>(argument) = events.front();
      events.pop_front();
      as<v4l2_event>(argument).pending = static_cast<std::uint32_t>(events.size());
      return 0;
    default:
      return answerQuery(request, argument);
  }
}

int FakeVideo::answerQuery(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& what = as<v4l2_capability>(argument);
      put(what.card, "Fake camera");
      put(what.driver, "fake");
      put(what.bus_info, "memory:7");
      what.capabilities = is_capability_per_device ? caps | V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_VIDEO_CAPTURE |
                                                         V4L2_CAP_STREAMING | V4L2_CAP_DEVICE_CAPS
                                                   : caps;
      what.device_caps = is_capability_per_device ? caps : 0;
      return 0;
    }
    case VIDIOC_G_INPUT:
      as<int>(argument) = static_cast<int>(input);
      return 0;
    case VIDIOC_G_SELECTION: {
      if (!sensor) return ENOTTY;
      auto& selection = as<v4l2_selection>(argument);
      selection.r = selection.target == V4L2_SEL_TGT_CROP ? window.value_or(*sensor) : *sensor;
      return 0;
    }
    case VIDIOC_S_SELECTION: {
      if (!sensor) return ENOTTY;
      window = as<v4l2_selection>(argument).r;
      window->left -= window->left % window_step;
      window->top -= window->top % window_step;
      return 0;
    }
    case VIDIOC_G_FMT:
      as<v4l2_format>(argument).fmt.pix = format;
      return 0;
    case VIDIOC_S_PARM:
      if (can_set_interval != 0) interval = as<v4l2_streamparm>(argument).parm.capture.timeperframe;
      as<v4l2_streamparm>(argument).parm.capture.capability = can_set_interval;
      return 0;
    case VIDIOC_G_PARM:
      as<v4l2_streamparm>(argument).parm.capture.timeperframe = interval;
      return 0;
    case VIDIOC_ENUM_FMT:
    case VIDIOC_ENUM_FRAMESIZES:
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return enumerate(request, argument);
    default:
      return answerControl(request, argument);
  }
}

int FakeVideo::enumerate(unsigned long request, void* argument) {
  if (request == VIDIOC_ENUM_FMT) {
    auto& entry = as<v4l2_fmtdesc>(argument);
    if (entry.index >= fourccs.size()) return EINVAL;
    entry.pixelformat = fourccs[entry.index];
    put(entry.description, "format " + std::to_string(entry.index));
    return 0;
  }
  if (request == VIDIOC_ENUM_FRAMESIZES) {
    auto& entry = as<v4l2_frmsizeenum>(argument);
    if (has_stepwise_sizes) {
      entry.type = V4L2_FRMSIZE_TYPE_STEPWISE;
      entry.stepwise = {16, 640, 8, 16, 480, 4};
      return 0;
    }
    if (entry.index >= sizes.size()) return EINVAL;
    entry.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    entry.discrete = sizes[entry.index];
    return 0;
  }
  auto& entry = as<v4l2_frmivalenum>(argument);
  if (has_stepwise_sizes) {
    entry.type = V4L2_FRMIVAL_TYPE_STEPWISE;
    entry.stepwise = {{1, 200}, {1, 5}, {1, 1000}};
    return 0;
  }
  if (entry.index > 0) return EINVAL;
  entry.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  entry.discrete = interval;
  return 0;
}

const v4l2_queryctrl* FakeVideo::findControl(std::uint32_t id) const {
  const bool next = (id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
  const std::uint32_t plain = id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
  const auto found = std::ranges::find_if(controls, [&](const v4l2_queryctrl& control) {
    return next ? control.id > plain : control.id == plain;
  });
  return found == controls.end() ? nullptr : &*found;
}

int FakeVideo::answerControl(unsigned long request, void* argument) {
  if (request == VIDIOC_QUERYCTRL) {
    auto& asked = as<v4l2_queryctrl>(argument);
    const v4l2_queryctrl* const found = findControl(asked.id);
    if (found == nullptr) return EINVAL;
    asked = *found;
    return 0;
  }
  if (request == VIDIOC_QUERYMENU) {
    auto& item = as<v4l2_querymenu>(argument);
    if (item.index % 2 != 0) return EINVAL;  // Menus have holes.
    std::memcpy(item.name, "choice", 7);     // The field is packed: no reference to it.
    return 0;
  }
  if (request != VIDIOC_S_CTRL && request != VIDIOC_G_CTRL) return ENOTTY;
  auto& control = as<v4l2_control>(argument);
  if (findControl(control.id) == nullptr) return EINVAL;
  if (request == VIDIOC_S_CTRL)
    values[control.id] = value_step > 1 ? control.value / value_step * value_step : control.value;
  control.value = values[control.id];
  return 0;
}

int FakeVideo::setFormat(v4l2_format& wanted) {
  if (!buffers_.empty()) return EBUSY;
  v4l2_pix_format& pix = wanted.fmt.pix;
  if (!is_stubborn_format && std::ranges::find(fourccs, pix.pixelformat) != fourccs.end()) {
    const std::uint32_t per_pixel =
        pix.pixelformat == V4L2_PIX_FMT_GREY || pix.pixelformat == V4L2_PIX_FMT_SRGGB8 ? 1 : 2;
    const std::uint32_t quantization = format.quantization;
    format = pix;
    format.quantization = quantization;
    format.bytesperline = pix.width * per_pixel;
    format.sizeimage = format.bytesperline * pix.height;
  }
  pix = format;
  return 0;
}

int FakeVideo::requestBuffers(v4l2_requestbuffers& wanted) {
  if (is_streaming_) return EBUSY;
  if (wanted.count == 0 && !mapped_.empty()) return EBUSY;
  buffers_.clear();
  queue_.clear();
  wanted.count = std::min(wanted.count, most_buffers);
  buffers_.resize(wanted.count);
  for (Buffer& buffer : buffers_) buffer.memory.resize(format.sizeimage + buffer_slack);
  return 0;
}

int FakeVideo::queryBuffer(v4l2_buffer& buffer) {
  if (buffer.index >= buffers_.size()) return EINVAL;
  buffer.length = static_cast<std::uint32_t>(buffers_[buffer.index].memory.size());
  buffer.m.offset = static_cast<std::uint32_t>(buffer.index * kOffsetStep);
  return 0;
}

void* FakeVideo::mmap(std::size_t length, int fd, std::int64_t offset) {
  EXPECT_EQ(fd, kFd);
  const auto index = static_cast<std::size_t>(offset / kOffsetStep);
  errno = mmap_error != 0 && mmap_fails_after-- <= 0 ? mmap_error : 0;
  if (errno == 0 && (index >= buffers_.size() || length > buffers_[index].memory.size())) errno = EINVAL;
  if (errno != 0) return nullptr;
  mapped_.insert(buffers_[index].memory.data());
  buffers_[index].is_mapped = true;
  return buffers_[index].memory.data();
}

int FakeVideo::munmap(void* address, std::size_t length) {
  EXPECT_EQ(mapped_.erase(address), 1U) << "not mapped";
  EXPECT_GT(length, 0U);
  return 0;
}

int FakeVideo::queue(v4l2_buffer& buffer) {
  if (buffer.index >= buffers_.size() || buffers_[buffer.index].is_queued) return EINVAL;
  buffers_[buffer.index].is_queued = true;
  queue_.push_back(buffer.index);
  return 0;
}

int FakeVideo::start() {
  if (buffers_.empty()) return EINVAL;
  is_streaming_ = true;
  return 0;
}

int FakeVideo::stop() {
  is_streaming_ = false;
  queue_.clear();
  for (Buffer& buffer : buffers_) buffer.is_queued = false;
  return 0;
}

bool FakeVideo::isReady() {
  return is_streaming_ && !queue_.empty() && !frames.empty() && frames.front().arrival_ns <= now_ns;
}

int FakeVideo::dequeue(v4l2_buffer& buffer) {
  if (!is_streaming_) return EINVAL;
  if (!isReady()) return EAGAIN;
  const FakeFrame frame = std::move(frames.front());
  frames.pop_front();
  const std::uint32_t index = queue_.front();
  queue_.pop_front();
  Buffer& slot = buffers_[index];
  slot.is_queued = false;
  std::copy_n(frame.bytes.begin(), std::min(frame.bytes.size(), slot.memory.size()), slot.memory.begin());
  buffer.index = given_index == UINT32_MAX ? index : given_index;
  buffer.sequence = frame.sequence;
  buffer.flags = frame.flags;
  buffer.bytesused = static_cast<std::uint32_t>(
      frame.bytesused < 0 ? static_cast<std::int64_t>(frame.bytes.size()) : frame.bytesused);
  buffer.timestamp.tv_sec = frame.stamp_ns / 1'000'000'000;
  buffer.timestamp.tv_usec = frame.stamp_ns % 1'000'000'000 / 1000;
  if (frame.odd_stamp) buffer.timestamp = *frame.odd_stamp;
  return 0;
}

int FakeVideo::poll(int fd, short events_wanted, short* revents, int timeout_ms) {
  EXPECT_EQ(fd, kFd);
  EXPECT_EQ(events_wanted, POLLIN | POLLPRI);
  EXPECT_GE(timeout_ms, 0);
  *revents = 0;
  errno = interruptions > 0 ? EINTR : poll_error;
  if (interruptions > 0) --interruptions;
  if (errno != 0) return -1;
  const std::int64_t deadline_ns = now_ns + std::int64_t{timeout_ms} * 1'000'000;
  if (is_streaming_ && !queue_.empty() && !frames.empty() && frames.front().arrival_ns <= deadline_ns) {
    now_ns = std::max(now_ns, frames.front().arrival_ns);
    if (frames.front().before) std::exchange(frames.front().before, nullptr)();
    *revents = POLLIN;
  }
  if (is_subscribed_ && !events.empty()) *revents |= POLLPRI;
  if (is_gone) *revents = POLLERR | POLLHUP;
  if (*revents == 0) *revents = idle_poll;
  if (*revents == 0) now_ns = deadline_ns;
  return *revents == 0 ? 0 : 1;
}

}  // namespace kerfbench::camera
