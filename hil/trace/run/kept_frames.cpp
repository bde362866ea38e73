// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/kept_frames.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "hil/base/png_codec.h"
#include "hil/report/html_text.h"
#include "hil/trace/json_text.h"

namespace kerfbench::trace {
namespace {

std::string windowText(const GrayImage& image) {
  return fmt::format(R"({{"x_px":{},"y_px":{},"width_px":{},"height_px":{}}})", image.left, image.top,
                     image.width, image.height);
}

std::string pngText(const GrayImage& image) {
  const auto png = base::encodePng({image.width, image.height, 1, 8, image.pixels}, base::PngEffort::kSmall);
  return report::base64({reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace

void KeptFrames::add(const Frame& frame) {
  if (every_ == 0 || frame.sequence % static_cast<std::uint64_t>(every_) != 0) return;
  if (!frame.image.pixels.empty()) keep(frame, frame.image);
  for (const GrayImage& window : frame.windows)
    if (!window.pixels.empty()) keep(frame, window);
}

void KeptFrames::keep(const Frame& frame, const GrayImage& image) {
  const auto time_ns = static_cast<std::uint64_t>(std::llround(1e9 * std::max(0.0, frame.start_s)));
  std::string text = "{";
  appendTimestamp(text, time_ns);
  text += fmt::format(R"(,"frame_id":"spot camera","format":"png","data":"{}",)", pngText(image));
  text += fmt::format(R"("sequence":{},"start_s":)", frame.sequence);
  appendNumber(text, frame.start_s, kSeconds);
  text += ",\"exposure_s\":";
  appendNumber(text, frame.exposure_s, kSeconds);
  text += fmt::format(R"(,"windows":[{}],"width_px":{},"height_px":{}}})", windowText(image), width_px_,
                      height_px_);
  const std::scoped_lock lock(mutex_);
  entries_.push_back({time_ns, frame.sequence, text_.size(), text.size()});
  text_.append(std::span<const char>(text.data(), text.size()));
}

void KeptFrames::forEach(const std::function<void(std::uint64_t, std::string_view)>& take) const {
  const std::scoped_lock lock(mutex_);
  std::vector<Entry> sorted = entries_;
  std::ranges::stable_sort(sorted, {}, [](const Entry& e) { return std::tuple(e.time_ns, e.sequence); });
  for (const Entry& entry : sorted) take(entry.time_ns, {text_.data() + entry.offset, entry.size});
}

}  // namespace kerfbench::trace
