// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot/spot_track.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

#include "hil/base/parallel.h"
#include "hil/vision/image/brightness_scan.h"
#include "hil/vision/image/window_scan.h"
#include "hil/vision/marks/mark_finder.h"
#include "hil/vision/spot/sheet_tracker.h"
#include "hil/vision/spot/spot_fit.h"
#include "hil/vision/spot/spot_grain.h"
#include "hil/vision/spot/spot_windows.h"
#include "twin/base/image.h"
#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr std::size_t kBatch = 16;
constexpr std::size_t kCandidates = 4;
constexpr std::size_t kSearchEvery = 20;  // Most frames between two searches.
constexpr double kSearchEveryMm = 5.0;    // Most travel of the belt between two searches.
constexpr int kDarkGray = 8;
constexpr double kSaturatedShare = 0.02;
// The spot itself may fill a few per cent of small windows.
constexpr double kSaturatedWindows = 0.25;
constexpr double kLatePeriods = 1.5;
// Share of the frames in which a fast jump may leave no time for marks.
constexpr double kMostWithoutRoom = 0.1;
// Shares of all marks that were expected.
constexpr double kMissingShare = 0.2;
constexpr double kMovedShare = 0.05;

/// Windows that a frame was asked for: first that of the spot, then those of marks, then bands to search.
struct Asked {
  std::vector<PixelWindow> windows;
  std::size_t first_band{};
};

/// Measurement of one frame alone.
struct Glance {
  std::optional<SpotFit> spot;
  double board_gray{};
  double noise_gray{};
  PixelNoise noise;
  FrameFaults faults;
  bool searched{};
  std::vector<FoundMark> marks;
  std::vector<SheetTracker::MarkGlance> expected;  ///< Marks where they should be.
};

/// Measurement of a frame that was read out by windows.
Glance glanceAtWindows(const Frame& frame, const CameraCalibration& calibration,
                       std::span<const double> diameters_mm, const ShotNoise& shot, std::size_t first_band) {
  Glance glance;
  const WindowLevels levels = levelsOf(frame.windows);
  glance.board_gray = levels.median;
  glance.noise_gray = levels.noise;
  glance.faults.dark = levels.median < kDarkGray;
  glance.faults.saturated = levels.saturated_share > kSaturatedWindows;
  glance.faults.lifeless = levels.lifeless;
  glance.noise = shot.on(glance.board_gray, glance.noise_gray);
  const GrayImage& around_spot = frame.windows.front();
  const int board = medianOf(around_spot);
  std::vector<BrightPeak> tried;
  while (!glance.spot && tried.size() < kCandidates) {
    const std::optional<BrightPeak> peak = brightestOf(around_spot, board, glance.noise_gray, tried);
    if (!peak) break;
    glance.spot = fitSpot(around_spot, *peak, board, glance.noise);
    tried.push_back(*peak);
  }
  glance.searched = first_band < frame.windows.size();
  for (std::size_t i = first_band; i < frame.windows.size(); ++i) {
    const GrayImage& band = frame.windows[i];
    if (band.pixels.empty()) continue;
    const std::vector<FoundMark> found = findMarks(band, calibration, Background(band), diameters_mm);
    glance.marks.insert(glance.marks.end(), found.begin(), found.end());
  }
  return glance;
}

Glance glanceAt(const Frame& frame, const CameraCalibration& calibration,
                std::span<const double> diameters_mm, const ShotNoise& shot, bool search) {
  Glance glance;
  const BrightnessScan scan = scanBrightness(frame.image, kCandidates);
  const Background& background = scan.background;
  glance.board_gray = background.median();
  glance.noise_gray = background.noise();
  glance.faults = {.dark = background.median() < kDarkGray,
                   .saturated = background.saturatedShare() > kSaturatedShare,
                   .blurred = false,
                   .lifeless = background.lifeless()};
  glance.noise = shot.on(glance.board_gray, glance.noise_gray);
  for (const BrightPeak& peak : scan.peaks) {
    glance.spot = fitSpot(frame.image, peak, background.at(peak.column, peak.row), glance.noise);
    if (glance.spot) break;
  }
  if (search) {
    glance.searched = true;
    glance.marks = findMarks(frame.image, calibration, background, diameters_mm);
  }
  return glance;
}

/// Frames between full searches: often enough that a mark does not run through the view unnoticed.
std::size_t searchStride(double period_s, double speed_mm_s) {
  const double per_frame_mm = std::abs(speed_mm_s * period_s);
  if (!(per_frame_mm > kSearchEveryMm / kSearchEvery)) return kSearchEvery;
  return static_cast<std::size_t>(std::max(1.0, kSearchEveryMm / per_frame_mm));
}

void placeSpot(FrameMeasurement& out, const SpotFit& fit, const CameraCalibration& calibration,
               double widest_mm) {
  const Eigen::Vector2d p_mm = calibration.planeFromPixel(fit.pixel);
  const Eigen::Matrix2d mm_per_pixel = calibration.localMap(p_mm).pixel_per_mm.inverse();
  const Eigen::Matrix2d covariance_mm2 = mm_per_pixel * fit.covariance_px2 * mm_per_pixel.transpose();
  out.spot_W_mm = p_mm;
  out.spot_sigma_mm = std::sqrt(0.5 * covariance_mm2.trace());
  const double scale_mm = std::sqrt(std::abs(mm_per_pixel.determinant()));
  out.faults.blurred = fit.short_sigma_px * scale_mm > widest_mm;
}

/// Where the spot's light reaches, nothing else can be measured.
SheetTracker::KeepOut keepOutOf(const Eigen::Vector2d& spot_mm, const SpotFit& fit, double pitch_mm) {
  return {spot_mm, (4.0 * fit.long_sigma_px + 2.0) * pitch_mm};
}

/// The spot shines on a mark: fit both, or find it in the ink where it does not outshine the board.
std::optional<SpotFit> fitWithPrint(const FrameView& view, const Glance& glance, const SheetTracker& tracker,
                                    const CameraCalibration& calibration, double pitch_mm) {
  if (glance.spot) {
    const Eigen::Vector2d p_mm = calibration.planeFromPixel(glance.spot->pixel);
    const double reach_mm = (4.0 * glance.spot->long_sigma_px + 6.0) * pitch_mm;
    const std::vector<DiscInPicture> discs = tracker.discs(p_mm, reach_mm);
    if (discs.empty()) return std::nullopt;
    const BrightPeak peak{static_cast<int>(glance.spot->pixel.x()), static_cast<int>(glance.spot->pixel.y()),
                          static_cast<int>(std::min(255.0, glance.spot->height_gray))};
    // The first window is the spot's.
    return fitSpot(view.parts().front(), peak, glance.board_gray, glance.noise, discs);
  }
  const GrayImage& around_spot = view.parts().front();
  for (const DiscInPicture& disc : tracker.discs(std::nullopt, 0.0)) {
    const double reach_px = disc.radius_mm / pitch_mm;
    const PixelWindow box{static_cast<int>(disc.pixel.x() - reach_px),
                          static_cast<int>(disc.pixel.y() - reach_px), static_cast<int>(2.0 * reach_px),
                          static_cast<int>(2.0 * reach_px)};
    if (box.within(around_spot.window()).empty()) continue;
    const std::optional<BrightPeak> peak =
        peakOnDisc(around_spot, disc, glance.board_gray, glance.noise_gray);
    if (!peak) continue;
    if (auto fit = fitSpot(around_spot, *peak, glance.board_gray, glance.noise, {&disc, 1})) return fit;
  }
  return std::nullopt;
}

void tellUnfit(SpotTrack& track, bool FrameFaults::*fault, const char* what) {
  const auto unfit = [&](const FrameMeasurement& frame) { return frame.faults.*fault; };
  const auto first = std::find_if(track.frames.begin(), track.frames.end(), unfit);
  if (first == track.frames.end()) return;
  track.problems.push_back(std::to_string(std::count_if(first, track.frames.end(), unfit)) +
                           " frames of the spot camera are " + what + ", the first is number " +
                           std::to_string(first->sequence) + ".");
}

void tellProblems(SpotTrack& track) {
  tellUnfit(track, &FrameFaults::dark, "dark");
  tellUnfit(track, &FrameFaults::saturated, "saturated");
  tellUnfit(track, &FrameFaults::blurred, "blurred");
  tellUnfit(track, &FrameFaults::lifeless, "without any noise");
  double expected = 0.0, seen = 0.0, moved = 0.0;
  for (const FrameMeasurement& frame : track.frames) {
    for (const SheetPose& pose : frame.sheet) {
      expected += pose.expected;
      seen += std::min(pose.expected, pose.marks + pose.moved);
      moved += pose.moved;
    }
  }
  if (expected - seen > kMissingShare * expected)
    track.problems.emplace_back("Printed marks are missing where the print has them.");
  if (moved > kMovedShare * expected)
    track.problems.emplace_back("Printed marks do not lie to each other as the print has them.");
}

/// Takes frames in batches: what each shows alone in parallel, what needs the frame before it in order.
class SpotFollower {
 public:
  SpotFollower(const CameraCalibration& calibration, const PrintLayout& print,
               const SpotTrackOptions& options)
      : calibration_(calibration),
        options_(options),
        tracker_(std::in_place, calibration, print, options.nominal_speed_mm_s, options.window),
        pitch_mm_(calibration.pitchMm()) {
    for (const RegistrationMark& mark : print.marks) {
      if (std::find(diameters_mm_.begin(), diameters_mm_.end(), mark.diameter_mm) == diameters_mm_.end()) {
        diameters_mm_.push_back(mark.diameter_mm);
      }
    }
  }

  /// Frames that can be asked for at once: before the marks are found, where to look next is known by each.
  [[nodiscard]] std::size_t batchSize() const {
    if (!ready()) return 1;
    if (!(options_.frame_period_s > 0.0)) return kBatch;
    return static_cast<std::size_t>(
        std::clamp(SheetTracker::kMostAhead_s / options_.frame_period_s, 1.0, double{kBatch}));
  }

  /// Windows of the next frame; called once for each of the next batch. None: the whole picture.
  std::vector<PixelWindow> windowsFor(double start_s) {
    Asked& asked = asked_.emplace_back();
    if (!ready()) return {};
    const auto box_W_mm = options_.aim(start_s, start_s + exposure_s_);
    if (!box_W_mm) return {};
    asked.windows = {spotWindow(calibration_, *box_W_mm)};
    const std::size_t number = done_ + asked_.size() - 1;
    const std::vector<PixelWindow> marks =
        markWindows(calibration_, tracker_->marksAt(start_s + 0.5 * exposure_s_));
    addThoseThatFit(marks, number, asked);
    if (!marks.empty() && asked.windows.size() == 1) ++without_room_;
    asked.first_band = asked.windows.size();
    if (searches(asked_.size() - 1))
      addThoseThatFit(markBands(calibration_, tracker_->marksOfLastUnit()), number / searchEvery(), asked);
    return asked.windows;
  }

  void add(const std::vector<Frame>& batch) {
    for (const Frame& frame : batch) checkSize(frame);
    learnTimes(batch);
    std::vector<Glance> glances(batch.size());
    base::forEachIndex(batch.size(), options_.threads, [&](std::size_t i) {
      glances[i] = batch[i].windows.empty()
                       ? glanceAt(batch[i], calibration_, diameters_mm_, shot_, searches(i))
                       : glanceAtWindows(batch[i], calibration_, diameters_mm_, shot_, asked_[i].first_band);
      lookAtMarks(batch[i], glances[i]);
    });
    // Whole pictures take a camera of windows longer than a period: they are there to find the marks by.
    if (!by_windows_ && !batch.empty() && !batch.front().windows.empty()) {
      by_windows_ = true;
      track_.frames.clear();
      track_.frames_lost = 0;
    }
    // In order, and cheap: what the marks say together, each frame by the one before.
    for (std::size_t i = 0; i < batch.size(); ++i) follow(batch[i], glances[i]);
    for (const Glance& glance : glances) {
      if (glance.spot) shot_.add(glance.spot->shot);
    }
    done_ += batch.size();
    asked_.clear();
  }

  SpotTrack finished() {
    tellProblems(track_);
    tellReadOut();
    return std::move(track_);
  }

 private:
  void tellReadOut() {
    if (!options_.aim || track_.frames.empty()) return;
    const auto share = static_cast<double>(without_room_) / static_cast<double>(track_.frames.size());
    if (share > kMostWithoutRoom) {
      track_.problems.push_back(fmt::format(
          "In {} of {} frames the spot camera had no time to read a printed mark beside the spot: it needs "
          "{:g} us for "
          "a row, and has {:g} us (cameras.spot.read_out, frames_per_s).",
          without_room_, track_.frames.size(), 1e6 * options_.read_out.row_s, 1e6 * options_.frame_period_s));
    }
    std::vector<double> gaps_s;
    for (std::size_t i = 1; i < track_.frames.size(); ++i) {
      const FrameMeasurement& before = track_.frames[i - 1];
      if (track_.frames[i].sequence == before.sequence + 1)
        gaps_s.push_back(track_.frames[i].mid_s - before.mid_s);
    }
    if (gaps_s.empty() || !(options_.frame_period_s > 0.0)) return;
    const double usual_s = upperMedianIn(gaps_s);
    if (usual_s > kLatePeriods * options_.frame_period_s) {
      track_.problems.push_back(fmt::format(
          "The spot camera gives a frame each {:g} ms, and not each {:g} ms: it is not ready in time{} "
          "(cameras.spot.read_out).",
          1e3 * usual_s, 1e3 * options_.frame_period_s,
          by_windows_ ? "" : ", as pictures stay whole until printed marks are found"));
    }
  }
  /// True if windows say where to look: the marks were found, or there are none.
  [[nodiscard]] bool ready() const {
    return exposure_s_ > 0.0 && (tracker_->locked() || diameters_mm_.empty());
  }
  [[nodiscard]] std::size_t searchEvery() const {
    if (options_.frame_period_s > 0.0)
      return searchStride(options_.frame_period_s, options_.nominal_speed_mm_s);
    return stride_ == 0 ? kSearchEvery : stride_;
  }
  /// Whether frame i of the batch is searched for marks all over.
  [[nodiscard]] bool searches(std::size_t i) const {
    return (options_.aim && !tracker_->locked()) || (done_ + i) % searchEvery() == 0;
  }
  /// Adds windows as long as the camera can read them out within its period, each time from the next one on.
  void addThoseThatFit(const std::vector<PixelWindow>& more, std::size_t turn, Asked& asked) const {
    constexpr double kMostOfPeriod = 0.98;
    constexpr int kMostBits = 12;
    for (std::size_t i = 0; i < more.size(); ++i) {
      asked.windows.push_back(more[(turn + i) % more.size()]);
      const bool fits =
          !(options_.frame_period_s > 0.0) ||
          options_.read_out.time_s(asked.windows, kMostBits) <= kMostOfPeriod * options_.frame_period_s;
      if (!fits) asked.windows.pop_back();
    }
  }

  void learnTimes(const std::vector<Frame>& batch) {
    if (stride_ == 0 && batch.size() > 1)
      stride_ = searchStride(batch[1].start_s - batch[0].start_s, options_.nominal_speed_mm_s);
    if (!batch.empty()) exposure_s_ = batch.back().exposure_s;
  }

  void checkSize(const Frame& frame) const {
    if (!frame.windows.empty()) return;
    const PixelWindow shown = frame.image.window();
    const PixelWindow wanted =
        options_.window.value_or(PixelWindow{0, 0, calibration_.width_px, calibration_.height_px});
    if (shown == wanted) return;
    throw std::invalid_argument(fmt::format(
        "frame {} is {} x {} px from ({}, {}) on, not {} x {} from ({}, {}) on", frame.sequence, shown.width,
        shown.height, shown.left, shown.top, wanted.width, wanted.height, wanted.left, wanted.top));
  }

  void countLost(const Frame& frame) {
    if (track_.frames.empty()) return;
    const std::uint64_t last = track_.frames.back().sequence;
    // A repeated or backward number is as untrustworthy as a gap.
    track_.frames_lost += frame.sequence > last ? frame.sequence - last - 1 : 1;
  }

  void follow(const Frame& frame, const Glance& glance) {
    FrameMeasurement out;
    out.faults = glance.faults;
    out.sequence = frame.sequence;
    out.mid_s = frame.start_s + 0.5 * frame.exposure_s;
    out.exposure_s = frame.exposure_s;
    countLost(frame);
    std::optional<SheetTracker::KeepOut> keep_out;
    const FrameView view(frame);
    if (glance.spot) {
      grain_.add(view.parts().front(), *glance.spot, glance.board_gray);
      place(out, *glance.spot, glance);
      keep_out = keepOutOf(*out.spot_W_mm, *glance.spot, pitch_mm_);
    }
    const std::vector<FoundMark>* const marks = glance.searched ? &glance.marks : nullptr;
    const std::optional<SheetTracker> before = glance.spot ? std::nullopt : tracker_;
    out.sheet = tracker_->step(view, out.mid_s, keep_out, marks, glance.expected);
    if (const auto better = fitWithPrint(view, glance, *tracker_, calibration_, pitch_mm_)) {
      place(out, *better, glance);
      if (before) {
        // A spot that print hid at first has shone into the marks: again, without those that it reaches.
        tracker_.emplace(*before);
        out.sheet = tracker_->step(view, out.mid_s, keepOutOf(*out.spot_W_mm, *better, pitch_mm_), marks,
                                   glance.expected);
      }
    }
    out.sheet.shrink_to_fit();  // Frames come by the million.
    track_.frames.push_back(std::move(out));
  }

  /// Where the marks should be by the batch before.
  void lookAtMarks(const Frame& frame, Glance& glance) const {
    std::optional<SheetTracker::KeepOut> keep_out;
    if (glance.spot)
      keep_out = keepOutOf(calibration_.planeFromPixel(glance.spot->pixel), *glance.spot, pitch_mm_);
    glance.expected = tracker_->glance(FrameView(frame), frame.start_s + 0.5 * frame.exposure_s, keep_out);
  }

  void place(FrameMeasurement& out, SpotFit fit, const Glance& glance) const {
    fit.covariance_px2 = grain_.centreCovariance(fit, glance.noise);
    placeSpot(out, fit, calibration_, options_.widest_spot_mm);
  }

  const CameraCalibration& calibration_;
  const SpotTrackOptions& options_;
  SpotTrack track_;
  std::optional<SheetTracker> tracker_;
  double pitch_mm_;
  std::vector<double> diameters_mm_;
  ShotNoise shot_;  // Learned from the batches before: the same at any number of threads.
  BoardGrain grain_;
  std::vector<Asked> asked_;  ///< What the batch was asked for that is being taken.
  double exposure_s_{0.0};
  bool by_windows_{false};
  std::size_t without_room_{0};  ///< Frames in which no mark could be read for want of time.
  std::size_t stride_{0};
  std::size_t done_{0};
};

}  // namespace

SpotTrack trackSpot(camera::FrameSource& source, const CameraCalibration& calibration,
                    const PrintLayout& print, const SpotTrackOptions& options) {
  SpotFollower follower(calibration, print, options);
  for (;;) {
    const std::vector<Frame> batch =
        options.aim ? source.nextWindowed(follower.batchSize(),
                                          [&](double start_s) { return follower.windowsFor(start_s); })
                    : source.nextBatch(kBatch);
    if (batch.empty()) break;
    follower.add(batch);
  }
  return follower.finished();
}

}  // namespace kerfbench::vision
