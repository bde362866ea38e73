// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/camera_settings.h"

#include <linux/videodev2.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace kerfbench::camera {
namespace {

constexpr double kExposureUnit_s = 100e-6;

class Setter {
 public:
  Setter(VideoDevice& device, const CameraSettings& settings) : device_(device), settings_(settings) {}

  CameraSetup run() {
    setWindow();
    setFormat();
    checkWindow();
    if (settings_.frame_rate_hz) setFrameRate(*settings_.frame_rate_hz);
    readPeriod();
    if (settings_.exposure_s) setExposure(*settings_.exposure_s);
    if (settings_.gain) setGain(*settings_.gain);
    for (const auto& [key, value] : settings_.controls) setByKey(key, value);
    if (!faults_.empty()) throw CameraSettingsError(device_.path(), std::move(faults_));
    return setup_;
  }

 private:
  void fault(const std::string& setting, std::string words) {
    faults_.push_back({setting, std::move(words)});
  }

  void requireLife(int error, const char* name) const {
    if (error == ENODEV) throwVideoError(error, device_.path(), name);
  }

  static PixelWindow windowOf(const v4l2_rect& r) {
    return {r.left, r.top, static_cast<int>(r.width), static_cast<int>(r.height)};
  }
  static std::string textOf(const PixelWindow& w) {
    return fmt::format("{} x {} at ({}, {})", w.width, w.height, w.left, w.top);
  }

  /// A rectangle of the selection API; nullopt where the driver has none.
  std::optional<PixelWindow> selection(std::uint32_t target) {
    v4l2_selection now{};
    now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    now.target = target;
    const int error = device_.request(VIDIOC_G_SELECTION, &now);
    requireLife(error, "VIDIOC_G_SELECTION");
    if (error != 0) return std::nullopt;
    return windowOf(now.r);
  }

  /// The sensor's rows and columns first: the format's size follows them.
  void setWindow() {
    const std::optional<PixelWindow> whole = selection(V4L2_SEL_TGT_CROP_DEFAULT);
    const std::optional<PixelWindow> now = selection(V4L2_SEL_TGT_CROP);
    if (!settings_.window && (!whole || !now || *whole == *now)) return;
    const PixelWindow wanted = settings_.window ? *settings_.window : *whole;
    if (settings_.window) {
      const PixelWindow picture{0, 0, settings_.width_px, settings_.height_px};
      if (wanted.empty() || wanted.within(picture) != wanted)
        return fault("window",
                     fmt::format("{} is no part of {} x {}", textOf(wanted), picture.width, picture.height));
      if (!whole) return fault("window", "the camera reads whole pictures alone");
      if (*whole != picture)
        return fault("window", fmt::format("the sensor has {}, the machine file's picture {} x {}",
                                           textOf(*whole), picture.width, picture.height));
    }
    v4l2_selection selection{};
    selection.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    selection.target = V4L2_SEL_TGT_CROP;
    selection.r = {wanted.left, wanted.top, static_cast<std::uint32_t>(wanted.width),
                   static_cast<std::uint32_t>(wanted.height)};
    const int error = device_.request(VIDIOC_S_SELECTION, &selection);
    requireLife(error, "VIDIOC_S_SELECTION");
    if (error != 0) return fault("window", std::strerror(error));
    set_window_ = wanted;
  }

  /// What the driver has made of the window, after the format.
  void checkWindow() {
    if (!set_window_) return;
    const PixelWindow& wanted = *set_window_;
    const std::optional<PixelWindow> got = selection(V4L2_SEL_TGT_CROP);
    if (!got) return fault("window", "the driver does not say what it is");
    if (*got != wanted) return fault("window", fmt::format("{} became {}", textOf(wanted), textOf(*got)));
    if (!settings_.window) return;
    setup_.layout.left_px = wanted.left;
    setup_.layout.top_px = wanted.top;
    if (setup_.layout.format != nullptr && setup_.layout.format->bayer != BayerOrder::kNone &&
        (wanted.left % 2 != 0 || wanted.top % 2 != 0))
      fault("window", "this format needs an even column and row to begin with");
  }

  /// Size of the frames that are to come.
  [[nodiscard]] int width() const { return settings_.window ? settings_.window->width : settings_.width_px; }
  [[nodiscard]] int height() const {
    return settings_.window ? settings_.window->height : settings_.height_px;
  }

  void setFormat() {
    const PixelFormat& format = *settings_.format;
    const int bits = settings_.bits == 0 ? format.bits : settings_.bits;
    if (bits != format.bits && (format.bits != 16 || bits < 8 || bits > 16))
      fault("bits", fmt::format("{} has {}", format.name, format.bits));
    v4l2_format wanted{};
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    wanted.fmt.pix.width = static_cast<std::uint32_t>(width());
    wanted.fmt.pix.height = static_cast<std::uint32_t>(height());
    wanted.fmt.pix.pixelformat = format.fourcc;
    wanted.fmt.pix.field = V4L2_FIELD_NONE;
    const int error = device_.request(VIDIOC_S_FMT, &wanted);
    requireLife(error, "VIDIOC_S_FMT");
    if (error != 0) {
      return fault(
          "format",
          fmt::format(
              "{}{}", std::strerror(error),
              error == EBUSY ? " (another program has it, or nobody writes into a loopback yet)" : ""));
    }
    if (wanted.fmt.pix.pixelformat != format.fourcc)
      return fault("format",
                   fmt::format("{} became {}", format.name, fourccText(wanted.fmt.pix.pixelformat)));
    if (wanted.fmt.pix.field != V4L2_FIELD_NONE) fault("format", "the pictures are interlaced");
    setup_.layout = currentLayout(device_, settings_);
    if (setup_.layout.width_px != width() || setup_.layout.height_px != height())
      fault("size", fmt::format("{} x {} became {} x {}", width(), height(), setup_.layout.width_px,
                                setup_.layout.height_px));
    checkRows();
  }

  void checkRows() {
    const FrameLayout& layout = setup_.layout;
    if (layout.format->packing == PixelPacking::kJpeg) return;
    const auto least =
        static_cast<std::size_t>(layout.width_px) * static_cast<std::size_t>(layout.format->bytesPerPixel());
    if (layout.stride_bytes < least)
      fault("format",
            fmt::format("rows of {} bytes hold no {} pixels", layout.stride_bytes, layout.width_px));
    const bool is_bayer = layout.format->bayer != BayerOrder::kNone;
    if ((is_bayer && (layout.width_px % 2 != 0 || layout.height_px % 2 != 0 || layout.width_px < 4 ||
                      layout.height_px < 4)) ||
        (layout.format->packing == PixelPacking::kYuyv && layout.width_px % 2 != 0))
      fault("size", "this format needs an even one");
  }

  void setFrameRate(double rate_hz) {
    constexpr double kParts = 1000.0;
    v4l2_streamparm wanted{};
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!(rate_hz >= 0.001) || rate_hz > 1e6) return fault("frame_rate_hz", "must be 0.001 ... 1e6");
    wanted.parm.capture.timeperframe.numerator = static_cast<std::uint32_t>(kParts);
    wanted.parm.capture.timeperframe.denominator = static_cast<std::uint32_t>(std::lround(kParts * rate_hz));
    const int error = device_.request(VIDIOC_S_PARM, &wanted);
    requireLife(error, "VIDIOC_S_PARM");
    if (error != 0) return fault("frame_rate_hz", std::strerror(error));
    if ((wanted.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) == 0)
      return fault("frame_rate_hz", "the driver cannot set it");
    asked_rate_ = true;
  }

  void readPeriod() {
    v4l2_streamparm now{};
    now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    const v4l2_fract& time = now.parm.capture.timeperframe;
    if (device_.request(VIDIOC_G_PARM, &now) == 0 && time.numerator > 0 && time.denominator > 0)
      setup_.frame_period_s = static_cast<double>(time.numerator) / time.denominator;
    if (!asked_rate_) return;
    if (!setup_.frame_period_s) return fault("frame_rate_hz", "the driver does not say what it is");
    setup_.outcomes.push_back({"frame_rate_hz", *settings_.frame_rate_hz, 1.0 / *setup_.frame_period_s});
  }

  /// What the device says of a control; nullopt and a fault where it has none that can be set.
  bool canSet(std::uint32_t id, const std::string& setting, std::int64_t value) {
    v4l2_queryctrl control{};
    control.id = id;
    const int error = device_.request(VIDIOC_QUERYCTRL, &control);
    requireLife(error, "VIDIOC_QUERYCTRL");
    if (error != 0 || (control.flags & V4L2_CTRL_FLAG_DISABLED) != 0)
      return fault(setting, "the camera has no such control"), false;
    if ((control.flags & (V4L2_CTRL_FLAG_READ_ONLY | V4L2_CTRL_FLAG_INACTIVE)) != 0)
      return fault(setting, "is read-only, or inactive for another control's sake"), false;
    if (value < control.minimum || value > control.maximum)
      return fault(setting, fmt::format("{}{} is not in {} ... {}", value,
                                        id == V4L2_CID_EXPOSURE_ABSOLUTE ? " (in 100 us)" : "",
                                        control.minimum, control.maximum)),
             false;
    return true;
  }

  std::optional<std::int32_t> set(std::uint32_t id, const std::string& setting, std::int32_t value) {
    if (!canSet(id, setting, value)) return std::nullopt;
    v4l2_control control{id, value};
    int error = device_.request(VIDIOC_S_CTRL, &control);
    if (error == 0) error = device_.request(VIDIOC_G_CTRL, &control);
    requireLife(error, "VIDIOC_S_CTRL");
    if (error != 0) return fault(setting, std::strerror(error)), std::nullopt;
    return control.value;
  }

  /// Off, where the camera has it at all; true if it is off or not there.
  bool switchOff(std::uint32_t id, std::int32_t off) {
    v4l2_control control{id, off};
    const int error = device_.request(VIDIOC_S_CTRL, &control);
    requireLife(error, "VIDIOC_S_CTRL");
    if (error == EINVAL && device_.request(VIDIOC_G_CTRL, &control) == EINVAL) return true;
    return error == 0 && device_.request(VIDIOC_G_CTRL, &control) == 0 && control.value == off;
  }

  void setExposure(double exposure_s) {
    if (!(exposure_s > 0.0) || exposure_s > 1000.0) return fault("exposure_s", "must be > 0 and <= 1000");
    if (!switchOff(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL))
      fault("exposure_s", "the camera's automatic exposure stays on");
    const auto units = static_cast<std::int32_t>(std::lround(exposure_s / kExposureUnit_s));
    const auto got = set(V4L2_CID_EXPOSURE_ABSOLUTE, "exposure_s", units);
    if (!got) return;
    setup_.exposure_s = *got * kExposureUnit_s;
    setup_.outcomes.push_back({"exposure_s", exposure_s, *setup_.exposure_s});
  }

  void setGain(std::int32_t gain) {
    if (!switchOff(V4L2_CID_AUTOGAIN, 0)) fault("gain", "the camera's automatic gain stays on");
    v4l2_queryctrl control{};
    control.id = V4L2_CID_GAIN;
    const bool has_gain = device_.request(VIDIOC_QUERYCTRL, &control) == 0;
    const auto got = set(has_gain ? V4L2_CID_GAIN : V4L2_CID_ANALOGUE_GAIN, "gain", gain);
    if (got) setup_.outcomes.push_back({"gain", static_cast<double>(gain), static_cast<double>(*got)});
  }

  void setByKey(const std::string& key, std::int32_t value) {
    v4l2_queryctrl control{};
    control.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    std::uint32_t last = 0;
    while (device_.request(VIDIOC_QUERYCTRL, &control) == 0 && control.id > last) {
      last = control.id;
      const auto* const name = reinterpret_cast<const char*>(control.name);
      if (controlKey({name, ::strnlen(name, sizeof control.name)}) == key) {
        const auto got = set(control.id, key, value);
        if (got) setup_.outcomes.push_back({key, static_cast<double>(value), static_cast<double>(*got)});
        return;
      }
      control.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
    fault(key, "the camera has no such control");
  }

  VideoDevice& device_;
  const CameraSettings& settings_;
  CameraSetup setup_;
  std::vector<SettingFault> faults_;
  bool asked_rate_{};
  std::optional<PixelWindow> set_window_;
};

std::string textOf(const std::string& path, const std::vector<SettingFault>& faults) {
  std::string text;
  for (const SettingFault& fault : faults)
    text += fmt::format("{}{}: {}", text.empty() ? path + ": " : "; ", fault.setting, fault.words);
  return text;
}

}  // namespace

CameraSettingsError::CameraSettingsError(const std::string& path, std::vector<SettingFault> faults)
    : std::invalid_argument(textOf(path, faults)), faults_(std::move(faults)) {}

FrameLayout currentLayout(VideoDevice& device, const CameraSettings& settings) {
  v4l2_format now{};
  now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device.require(VIDIOC_G_FMT, &now, "VIDIOC_G_FMT");
  const v4l2_pix_format& pix = now.fmt.pix;
  FrameLayout layout;
  layout.format = findPixelFormat(pix.pixelformat);
  layout.width_px = static_cast<int>(pix.width);
  layout.height_px = static_cast<int>(pix.height);
  layout.stride_bytes = pix.bytesperline;
  layout.most_bytes = pix.sizeimage;
  layout.bits = settings.bits != 0 ? settings.bits : settings.format->bits;
  // Brightness and colour without a word are 16 ... 235 by default, but for JPEG's own colours.
  layout.full_range =
      pix.quantization == V4L2_QUANTIZATION_FULL_RANGE ||
      (pix.quantization == V4L2_QUANTIZATION_DEFAULT && pix.colorspace == V4L2_COLORSPACE_JPEG);
  return layout;
}

CameraSetup setUpCamera(VideoDevice& device, const CameraSettings& settings) {
  if (settings.format == nullptr || settings.width_px <= 0 || settings.height_px <= 0)
    throw CameraSettingsError(device.path(), {{"format", "format and size must be told"}});
  return Setter(device, settings).run();
}

}  // namespace kerfbench::camera
