// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/v4l2_frames.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil/camera/v4l2/gray_decode.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

constexpr std::size_t kKeptIncidents = 1000;

const V4l2FrameOptions& checked(const V4l2FrameOptions& options) {
  std::string faults;
  if (!(options.exposure_s > 0.0)) faults += "; exposure_s must be > 0";
  if (options.frames == 0) faults += "; frames must be > 0";
  if (options.timeout_ms <= 0) faults += "; timeout_ms must be > 0";
  if (!faults.empty()) throw std::invalid_argument("V4l2FrameSource: " + faults.substr(2));
  return options;
}

WatchOptions watchOf(const V4l2FrameOptions& options, const CameraSetup& setup) {
  WatchOptions watch = options.watch;
  if (!watch.period_s && !options.is_triggered) watch.period_s = setup.frame_period_s;
  return watch;
}

}  // namespace

V4l2FrameSource::V4l2FrameSource(BufferStream& stream, CameraClock clock, const V4l2FrameOptions& options)
    : stream_(stream),
      clock_(std::move(clock)),
      options_(checked(options)),
      watch_(watchOf(options, stream.setup())) {}

double V4l2FrameSource::begin_s(std::int64_t stamp_ns) const {
  return clock_.beginOf_s(static_cast<double>(stamp_ns) * 1e-9);
}

void V4l2FrameSource::tell(CaptureIncident incident) {
  ++report_.incidents;
  if (report_.first_incidents.size() < kKeptIncidents) report_.first_incidents.push_back(std::move(incident));
}

void V4l2FrameSource::tell(const FrameIntegrity& integrity, const std::string& why_unreadable) {
  const double from_s = begin_s(integrity.from_ns);
  const double to_s = begin_s(integrity.to_ns);
  if (integrity.lost_before > 0)
    tell({from_s, to_s, integrity.sequence, fmt::format("{} frames were lost", integrity.lost_before)});
  for (const FrameFault fault : integrity.faults) {
    std::string words(nameOf(fault));
    if (fault == FrameFault::kUnreadable) words += ": " + why_unreadable;
    tell({from_s, to_s, integrity.sequence, std::move(words)});
  }
}

void V4l2FrameSource::take(const StreamEvent& event, std::vector<Frame>& frames) {
  const bool is_same = std::ranges::equal(event.bytes, last_bytes_);
  last_bytes_.assign(event.bytes.begin(), event.bytes.end());
  GrayImage image;
  std::string why_unreadable;
  try {
    image = decodeFrame(stream_.setup().layout, event.bytes);
  } catch (const std::invalid_argument& error) {
    why_unreadable = error.what();
  }
  const FrameIntegrity integrity = watch_.judge(event.note, is_same, !why_unreadable.empty());
  ++report_.taken;
  report_.lost += integrity.lost_before;
  report_.clock = event.note.clock;
  report_.worst_ahead_s = std::max(report_.worst_ahead_s,
                                   static_cast<double>(event.note.stamp_ns - event.note.arrival_ns) * 1e-9);
  tell(integrity, why_unreadable);
  if (!integrity.isGood()) return;
  ++report_.good;
  frames.push_back({std::move(image), integrity.sequence, begin_s(event.note.stamp_ns), options_.exposure_s});
}

std::vector<Frame> V4l2FrameSource::nextBatch(std::size_t max) {
  std::vector<Frame> frames;
  while (frames.size() < max && report_.taken < options_.frames && report_.ended_early.empty()) {
    const StreamEvent event = stream_.next(options_.timeout_ms);
    if (event.kind != StreamEvent::Kind::kFrame) {
      report_.ended_early = event.words;
    } else if (discarded_ < options_.discard) {
      ++discarded_;
    } else {
      take(event, frames);
    }
  }
  return frames;
}

}  // namespace kerfbench::camera
