// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/device_list.h"

#include <linux/videodev2.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "hil/camera/v4l2/pixel_format.h"
#include "hil/camera/v4l2/video_device.h"

namespace kerfbench::camera {
namespace {

// A driver that never says "no more" is broken; it must not hang the bench.
constexpr std::uint32_t kMostEntries = 1000;

template <std::size_t n>
std::string textOf(const __u8 (&field)[n]) {
  const auto* const text = reinterpret_cast<const char*>(field);
  return {text, ::strnlen(text, n)};
}

double secondsOf(const v4l2_fract& fraction) {
  return fraction.denominator == 0 ? 0.0 : static_cast<double>(fraction.numerator) / fraction.denominator;
}

std::vector<IntervalListing> intervalsOf(VideoDevice& device, std::uint32_t fourcc, int width, int height) {
  std::vector<IntervalListing> found;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_frmivalenum entry{};
    entry.index = i;
    entry.pixel_format = fourcc;
    entry.width = static_cast<std::uint32_t>(width);
    entry.height = static_cast<std::uint32_t>(height);
    if (device.request(VIDIOC_ENUM_FRAMEINTERVALS, &entry) != 0) break;
    if (entry.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      found.push_back({secondsOf(entry.discrete), secondsOf(entry.discrete)});
    } else {
      found.push_back({secondsOf(entry.stepwise.min), secondsOf(entry.stepwise.max)});
      break;
    }
  }
  return found;
}

SizeListing sizeOf(const v4l2_frmsizeenum& entry) {
  const auto px = [](std::uint32_t value) { return static_cast<int>(value); };
  if (entry.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
    const int width = px(entry.discrete.width);
    const int height = px(entry.discrete.height);
    return {width, height, width, height, 0, 0, {}};
  }
  const v4l2_frmsize_stepwise& range = entry.stepwise;
  return {px(range.min_width),
          px(range.min_height),
          px(range.max_width),
          px(range.max_height),
          px(range.step_width),
          px(range.step_height),
          {}};
}

std::vector<SizeListing> sizesOf(VideoDevice& device, std::uint32_t fourcc) {
  std::vector<SizeListing> sizes;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_frmsizeenum entry{};
    entry.index = i;
    entry.pixel_format = fourcc;
    if (device.request(VIDIOC_ENUM_FRAMESIZES, &entry) != 0) break;
    SizeListing size = sizeOf(entry);
    size.intervals = intervalsOf(device, fourcc, size.max_width_px, size.max_height_px);
    sizes.push_back(size);
    if (entry.type != V4L2_FRMSIZE_TYPE_DISCRETE) break;
  }
  return sizes;
}

std::vector<FormatListing> formatsOf(VideoDevice& device) {
  std::vector<FormatListing> formats;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_fmtdesc entry{};
    entry.index = i;
    entry.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (device.request(VIDIOC_ENUM_FMT, &entry) != 0) break;
    const PixelFormat* const known = findPixelFormat(entry.pixelformat);
    formats.push_back({fourccText(entry.pixelformat), textOf(entry.description), known != nullptr,
                       known != nullptr ? std::string(known->cost) : "", sizesOf(device, entry.pixelformat)});
  }
  return formats;
}

std::vector<std::string> menuOf(VideoDevice& device, const v4l2_queryctrl& control) {
  std::vector<std::string> items;
  for (std::int64_t i = control.minimum; i <= control.maximum && items.size() < kMostEntries; ++i) {
    v4l2_querymenu item{};
    item.id = control.id;
    item.index = static_cast<std::uint32_t>(i);
    if (device.request(VIDIOC_QUERYMENU, &item) == 0)
      items.push_back(fmt::format("{}: {}", i, textOf(item.name)));
  }
  return items;
}

std::optional<ControlListing> controlOf(VideoDevice& device, const v4l2_queryctrl& control) {
  if (control.type == V4L2_CTRL_TYPE_CTRL_CLASS) return std::nullopt;
  constexpr std::uint32_t kLocked =
      V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY | V4L2_CTRL_FLAG_INACTIVE;
  ControlListing listing;
  listing.id = control.id;
  listing.name = textOf(control.name);
  listing.key = controlKey(listing.name);
  listing.min = control.minimum;
  listing.max = control.maximum;
  listing.step = control.step;
  listing.fallback = control.default_value;
  listing.is_locked = (control.flags & kLocked) != 0;
  v4l2_control now{control.id, 0};
  listing.has_value =
      (control.flags & V4L2_CTRL_FLAG_WRITE_ONLY) == 0 && device.request(VIDIOC_G_CTRL, &now) == 0;
  listing.value = now.value;
  if (control.type == V4L2_CTRL_TYPE_MENU) listing.menu = menuOf(device, control);
  return listing;
}

std::vector<ControlListing> controlsOf(VideoDevice& device) {
  std::vector<ControlListing> controls;
  v4l2_queryctrl control{};
  control.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    if (device.request(VIDIOC_QUERYCTRL, &control) != 0) break;
    if (auto listing = controlOf(device, control)) controls.push_back(std::move(*listing));
    control.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return controls;
}

CameraListing look(VideoCalls& calls, const std::string& path) {
  CameraListing camera;
  camera.path = path;
  try {
    VideoDevice device(calls, path);
    v4l2_capability what{};
    device.require(VIDIOC_QUERYCAP, &what, "VIDIOC_QUERYCAP");
    camera.card = textOf(what.card);
    camera.driver = textOf(what.driver);
    camera.bus = textOf(what.bus_info);
    const std::uint32_t can =
        (what.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? what.device_caps : what.capabilities;
    camera.captures = (can & V4L2_CAP_VIDEO_CAPTURE) != 0 && (can & V4L2_CAP_STREAMING) != 0;
    if (!camera.captures) return camera;
    camera.formats = formatsOf(device);
    camera.controls = controlsOf(device);
  } catch (const std::system_error& error) {
    camera.problem = problemOf(error);
  }
  return camera;
}

std::string rateText(const IntervalListing& interval) {
  if (interval.shortest_s <= 0.0 || interval.longest_s <= 0.0) return "?";
  if (interval.shortest_s == interval.longest_s) return fmt::format("{:.4g}", 1.0 / interval.shortest_s);
  return fmt::format("{:.4g} ... {:.4g}", 1.0 / interval.longest_s, 1.0 / interval.shortest_s);
}

std::string sizeText(const SizeListing& size) {
  std::string text = fmt::format("{} x {}", size.width_px, size.height_px);
  if (size.max_width_px != size.width_px || size.max_height_px != size.height_px)
    text += fmt::format(" ... {} x {} in steps of {} x {}", size.max_width_px, size.max_height_px,
                        size.step_width_px, size.step_height_px);
  std::string rates;
  for (const IntervalListing& interval : size.intervals)
    rates += (rates.empty() ? "" : ", ") + rateText(interval);
  return rates.empty() ? text : text + " at " + rates + " frames/s";
}

std::string controlText(const ControlListing& control) {
  std::string text = fmt::format("{} [{} ... {}, step {}, default {}]", control.key, control.min, control.max,
                                 control.step, control.fallback);
  if (control.has_value) text += fmt::format(" = {}", control.value);
  if (control.is_locked) text += ", locked";
  for (const std::string& item : control.menu) text += "\n      " + item;
  return text;
}

}  // namespace

std::string problemOf(const std::system_error& error) {
  switch (error.code().value()) {
    case EACCES:
    case EPERM:
      return "no permission: add the user to the group \"video\", or give the device a udev rule";
    case EBUSY:
      return "another program has it";
    case ENODEV:
    case ENXIO:
    case ENOENT:
      return "the device has gone";
    default:
      return error.what();
  }
}

std::vector<CameraListing> listCameras(VideoCalls& calls) {
  std::vector<CameraListing> cameras;
  for (const std::string& path : calls.nodes()) cameras.push_back(look(calls, path));
  return cameras;
}

std::string describe(const CameraListing& camera) {
  if (camera.card.empty()) return fmt::format("{}: {}\n", camera.path, camera.problem);
  std::string text =
      fmt::format("{}: {} (driver {}, {})\n", camera.path, camera.card, camera.driver, camera.bus);
  if (!camera.problem.empty()) text += "  " + camera.problem + "\n";
  if (!camera.captures) return text + "  gives no pictures by streaming\n";
  for (const FormatListing& format : camera.formats) {
    text += fmt::format("  {} ({}){}\n", format.fourcc, format.description,
                        format.is_readable ? "" : ": cannot be read");
    if (!format.cost.empty()) text += "    " + format.cost + "\n";
    for (const SizeListing& size : format.sizes) text += "    " + sizeText(size) + "\n";
  }
  for (const ControlListing& control : camera.controls) text += "    " + controlText(control) + "\n";
  return text;
}

}  // namespace kerfbench::camera
