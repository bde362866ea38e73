// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/marks/constellation.h"
#include "hil/vision/marks/mark_finder.h"
#include "hil/vision/spot/frame_view.h"
#include "hil/vision/spot/spot_fit.h"
#include "hil/vision/spot/spot_track.h"
#include "twin/base/print_layout.h"

namespace kerfbench::vision {

/// Follows the printed marks from frame to frame. Frames must come in order; all state is here, so the result
/// depends on nothing else.
class SheetTracker {
 public:
  /// `window`: the part of the picture that all frames show; absent: all of it.
  SheetTracker(const CameraCalibration& calibration, const PrintLayout& print, double nominal_speed_mm_s,
               const std::optional<PixelWindow>& window = std::nullopt);

  /// Area of the glowing spot, where no mark can be measured.
  struct KeepOut {
    Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
    double radius_mm{};
  };

  /// A mark that was looked for where it should be.
  struct MarkGlance {
    int unit{};
    std::size_t mark{};  ///< Index in the print.
    std::optional<FoundMark> found;
  };
  /// Frames that come at once are predicted from the one before the first: no farther ahead than this.
  static constexpr double kMostAhead_s = 0.02;
  /// Looks for the marks of a frame that follows soon, from the state as it is: several frames can be looked
  /// at at once. None of a frame that comes later.
  [[nodiscard]] std::vector<MarkGlance> glance(const FrameView& view, double time_s,
                                               const std::optional<KeepOut>& spot) const;

  /// Poses of the units in view. `all_marks` is the result of a full search of this frame, where one was
  /// made; `glances` that of glance(), for what it has: other marks are looked for now.
  std::vector<SheetPose> step(const FrameView& view, double time_s, const std::optional<KeepOut>& spot,
                              const std::vector<FoundMark>* all_marks,
                              std::span<const MarkGlance> glances = {});

  /// Place where a mark should be.
  struct MarkPlace {
    Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
    double diameter_mm{};
    double search_mm{};  ///< How far from there it is looked for.
  };
  /// True once the sheet's place is known.
  [[nodiscard]] bool locked() const { return !units_.empty(); }
  /// Marks that step() would look for at a time; of all units in view and about to be. Empty before a lock.
  [[nodiscard]] std::vector<MarkPlace> marksAt(double time_s) const;
  /// Places of the print's marks of the unit seen last, in view or not, and how far off they may be while the
  /// sheet's angle is not known. Empty before a lock.
  [[nodiscard]] std::vector<MarkPlace> marksOfLastUnit() const;

  /// Printed discs as they lie in the picture of the last step(), measured or not; only those within reach_mm
  /// of `near_mm`, or all.
  [[nodiscard]] std::vector<DiscInPicture> discs(const std::optional<Eigen::Vector2d>& near_mm,
                                                 double reach_mm) const;

 private:
  struct UnitState {
    PlaneMotion motion;       ///< Place of the unit's frame S.
    double angle_variance{};  ///< Variance of motion.angle_rad, rad².
    double time_s{};
  };

  /// State of the unit itself or of its freshest neighbour.
  [[nodiscard]] UnitState predict(int unit, double time_s) const;
  [[nodiscard]] double looseness(int unit, double time_s) const;
  [[nodiscard]] bool markInView(const Eigen::Vector2d& p_mm, double diameter_mm) const;
  [[nodiscard]] DiscInPicture discAt(const Eigen::Vector2d& p_mm, double diameter_mm) const;
  void poolNoise(std::vector<MarkPair>& pairs, std::span<const double> diameters_mm);
  bool lock(const std::vector<FoundMark>& seen, double time_s);
  std::vector<SheetPose> measure(const FrameView& view, double time_s, const std::optional<KeepOut>& spot,
                                 std::span<const MarkGlance> glances);
  /// A mark in a part of the picture, near p_mm.
  [[nodiscard]] std::optional<FoundMark> measured(const GrayImage& part, int unit, std::size_t mark,
                                                  const Eigen::Vector2d& p_mm, double search_mm) const;
  /// Whether the spot shines on a mark at p_mm.
  static bool isCovered(const Eigen::Vector2d& p_mm, double diameter_mm, const std::optional<KeepOut>& spot) {
    return spot && (p_mm - spot->p_mm).norm() < 0.7 * diameter_mm + spot->radius_mm;
  }
  /// The first and the last unit that marks are looked for of.
  [[nodiscard]] std::pair<int, int> unitsToLookFor() const;
  /// The marks of one unit in one picture.
  struct Sighting {
    std::vector<MarkPair> pairs;
    std::vector<std::size_t> marks;  ///< Index in the print of each pair.
    std::vector<double> diameters_mm;
    std::vector<MarkLevels> levels;
    int in_view{0};  ///< Marks that should be found for certain.
  };
  [[nodiscard]] Sighting lookForMarks(const FrameView& view, int unit, const PlaneMotion& expected,
                                      double search_mm, const std::optional<KeepOut>& spot,
                                      std::span<const MarkGlance> glances) const;
  void keepUnits(const std::map<int, UnitState>& measured, double time_s);
  [[nodiscard]] int explained(const std::vector<FoundMark>& seen,
                              const std::map<int, PlaneMotion>& poses) const;

  const CameraCalibration& calibration_;
  const PrintLayout& print_;
  PixelWindow shown_;  ///< What frames show.
  double pitch_mm_;    ///< Pitch of the pixels.
  double speed_mm_s_;  ///< Speed of the web along x, as measured; nominal at first.
  double largest_diameter_mm_{};
  std::map<int, UnitState> units_;
  std::map<std::pair<int, std::size_t>, MarkLevels> levels_;  ///< Levels by unit and mark, as seen of late.
  double contrast_gray_{80.0};
  double pooled_mm3_{};  ///< Mean of variance times diameter of the marks so far.
  double pooled_{};      ///< Number of marks in pooled_mm3_.
  bool angle_known_{};   ///< True once two marks of a unit were seen at once.
  double time_s_{};
};

}  // namespace kerfbench::vision
