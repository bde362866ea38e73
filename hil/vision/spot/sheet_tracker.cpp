// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot/sheet_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/LU>

#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

// A unit seen in the last frame moves as predicted but for the belt's acceleration; the next unit also by
// errors of the print's pitch.
constexpr double kTightMm = 0.6;
constexpr double kLooseMm = 1.5;
constexpr double kLoosestMm = 4.0;
// Marks that disagree by more are not marks, or the spot shines into them.
constexpr double kDisagreementMm = 0.06;
// Marks whose noise is taken together: enough that the estimate is no longer the noisier of the two.
constexpr double kPooledMarks = 16.0;

/// One mark tells where S lies only as well as the angle kept from before is known: they err together.
void keepAngle(MotionFit& fit, std::span<const MarkPair> pairs, double angle_variance) {
  const Eigen::Vector2d arm =
      std::min_element(pairs.begin(), pairs.end(), [&](const MarkPair& a, const MarkPair& b) {
        return (fit.motion * a.p_mm - a.q_mm).norm() < (fit.motion * b.p_mm - b.q_mm).norm();
      })->p_mm;
  const Eigen::Vector2d turned = fit.motion.rotation() * arm;
  const Eigen::Vector3d by_angle(turned.y(), -turned.x(), 1.0);
  fit.covariance += angle_variance * by_angle * by_angle.transpose();
}

/// Variance of the angle by a match of these discs: of their greatest distance, or nothing but its limits.
double angleVarianceOf(const std::vector<FoundMark>& seen, double max_angle_rad) {
  double smallest = max_angle_rad * max_angle_rad / 3.0;
  for (const FoundMark& a : seen) {
    for (const FoundMark& b : seen) {
      const double squares = a.sigma_mm * a.sigma_mm + b.sigma_mm * b.sigma_mm;
      const double distance2 = (a.p_mm - b.p_mm).squaredNorm();
      if (squares < smallest * distance2) smallest = squares / distance2;
    }
  }
  return smallest;
}

}  // namespace

SheetTracker::SheetTracker(const CameraCalibration& calibration, const PrintLayout& print,
                           double nominal_speed_mm_s, const std::optional<PixelWindow>& window)
    : calibration_(calibration),
      print_(print),
      shown_(window.value_or(PixelWindow{0, 0, calibration.width_px, calibration.height_px})),
      pitch_mm_(calibration.pitchMm()),
      speed_mm_s_(nominal_speed_mm_s) {
  for (const RegistrationMark& mark : print.marks) {
    largest_diameter_mm_ = std::max(largest_diameter_mm_, mark.diameter_mm);
  }
}

SheetTracker::UnitState SheetTracker::predict(int unit, double time_s) const {
  // The freshest neighbour, the nearest of them.
  const UnitState* from = nullptr;
  int from_unit = 0;
  for (const auto& [k, state] : units_) {
    const bool better = from == nullptr || state.time_s > from->time_s ||
                        (state.time_s == from->time_s && std::abs(k - unit) < std::abs(from_unit - unit));
    if (k == unit && state.time_s >= time_s_) {
      from = &state;
      from_unit = k;
      break;
    }
    if (better) {
      from = &state;
      from_unit = k;
    }
  }
  if (from == nullptr) throw std::logic_error("SheetTracker::predict: no unit has been seen yet");
  PlaneMotion motion = from->motion;
  motion.shift_mm += motion.rotation() * Eigen::Vector2d((from_unit - unit) * print_.pitch_mm, 0.0);
  motion.shift_mm.x() += speed_mm_s_ * (time_s - from->time_s);
  return {motion, from->angle_variance, from->time_s};
}

double SheetTracker::looseness(int unit, double time_s) const {
  const auto own = units_.find(unit);
  double last = -std::numeric_limits<double>::infinity();
  for (const auto& [k, state] : units_) last = std::max(last, state.time_s);
  const double blind_mm = std::abs(speed_mm_s_) * (time_s - last);
  if (own != units_.end() && own->second.time_s == last) return kTightMm + std::min(0.1 * blind_mm, kLooseMm);
  return std::min(kLoosestMm, kLooseMm + 0.1 * blind_mm);
}

bool SheetTracker::markInView(const Eigen::Vector2d& p_mm, double diameter_mm) const {
  const double radius_px = 0.5 * diameter_mm / pitch_mm_;
  // The scale varies a little over the picture.
  const double border_px = 1.1 * markBorderPx(radius_px);
  const std::optional<Eigen::Vector2d> pixel = calibration_.pixelIfSeen(p_mm, border_px);
  return pixel && pixel->x() >= shown_.left + border_px && pixel->x() <= shown_.right() - border_px &&
         pixel->y() >= shown_.top + border_px && pixel->y() <= shown_.bottom() - border_px;
}

DiscInPicture SheetTracker::discAt(const Eigen::Vector2d& p_mm, double diameter_mm) const {
  const LocalPixelMap map = calibration_.localMap(p_mm);
  return {map.pixel, map.pixel_per_mm.inverse(), 0.5 * diameter_mm, contrast_gray_};
}

std::vector<DiscInPicture> SheetTracker::discs(const std::optional<Eigen::Vector2d>& near_mm,
                                               double reach_mm) const {
  std::vector<DiscInPicture> out;
  if (units_.empty()) return out;
  const auto [first, last] = unitsToLookFor();
  for (int unit = first; unit <= last; ++unit) {
    const PlaneMotion motion = predict(unit, time_s_).motion;
    for (const RegistrationMark& mark : print_.marks) {
      const Eigen::Vector2d p_mm = motion * mark.p_SM_mm;
      if (near_mm && (p_mm - *near_mm).norm() > reach_mm + 0.5 * mark.diameter_mm) continue;
      if (calibration_.pixelIfSeen(p_mm, -0.5 * mark.diameter_mm / pitch_mm_)) {
        out.push_back(discAt(p_mm, mark.diameter_mm));
      }
    }
  }
  return out;
}

std::pair<int, int> SheetTracker::unitsToLookFor() const {
  return {std::max(0, units_.begin()->first - 1), std::min(print_.units - 1, units_.rbegin()->first + 1)};
}

std::vector<SheetTracker::MarkPlace> SheetTracker::marksAt(double time_s) const {
  std::vector<MarkPlace> places;
  if (units_.empty()) return places;
  const auto [first, last] = unitsToLookFor();
  for (int unit = first; unit <= last; ++unit) {
    const PlaneMotion motion = predict(unit, time_s).motion;
    const double search_mm = looseness(unit, time_s);
    for (const RegistrationMark& mark : print_.marks) {
      const Eigen::Vector2d p_mm = motion * mark.p_SM_mm;
      // One that is nearly in view may be by then.
      if (calibration_.pixelIfSeen(p_mm, -search_mm / pitch_mm_))
        places.push_back({p_mm, mark.diameter_mm, search_mm});
    }
  }
  return places;
}

std::vector<SheetTracker::MarkPlace> SheetTracker::marksOfLastUnit() const {
  std::vector<MarkPlace> places;
  if (units_.empty()) return places;
  // As far as a lock may turn a sheet.
  const double turn_rad = angle_known_ ? 0.0 : ConstellationQuery{}.max_angle_rad;
  for (const RegistrationMark& mark : print_.marks) {
    double farthest_mm = 0.0;
    for (const RegistrationMark& other : print_.marks)
      farthest_mm = std::max(farthest_mm, (mark.p_SM_mm - other.p_SM_mm).norm());
    places.push_back(
        {units_.rbegin()->second.motion * mark.p_SM_mm, mark.diameter_mm, turn_rad * farthest_mm});
  }
  return places;
}

/// The noise by twelve sectors of one edge scatters by a quarter; the marks before had the same noise, but
/// for the length of their edge.
void SheetTracker::poolNoise(std::vector<MarkPair>& pairs, std::span<const double> diameters_mm) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double own = pairs[i].sigma_mm * pairs[i].sigma_mm * diameters_mm[i];
    pooled_ = std::min(pooled_ + 1.0, kPooledMarks);
    pooled_mm3_ += (own - pooled_mm3_) / pooled_;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].sigma_mm = std::sqrt(pooled_mm3_ / diameters_mm[i]);
}

std::optional<FoundMark> SheetTracker::measured(const GrayImage& part, int unit, std::size_t mark,
                                                const Eigen::Vector2d& p_mm, double search_mm) const {
  const auto before = levels_.find({unit, mark});
  const auto known = before == levels_.end() ? std::nullopt : std::optional(before->second);
  return measureMark(part, calibration_, p_mm, print_.marks[mark].diameter_mm, search_mm, known);
}

std::vector<SheetTracker::MarkGlance> SheetTracker::glance(const FrameView& view, double time_s,
                                                           const std::optional<KeepOut>& spot) const {
  std::vector<MarkGlance> glances;
  if (units_.empty() || time_s - time_s_ > kMostAhead_s) return glances;
  const auto [first, last] = unitsToLookFor();
  for (int unit = first; unit <= last; ++unit) {
    const PlaneMotion expected = predict(unit, time_s).motion;
    const double search_mm = looseness(unit, time_s);
    for (std::size_t i = 0; i < print_.marks.size(); ++i) {
      const RegistrationMark& mark = print_.marks[i];
      const Eigen::Vector2d p_mm = expected * mark.p_SM_mm;
      if (!markInView(p_mm, mark.diameter_mm) || isCovered(p_mm, mark.diameter_mm, spot)) continue;
      if (const GrayImage* const part = view.around(calibration_.pixelFromPlane(p_mm)))
        glances.push_back({unit, i, measured(*part, unit, i, p_mm, search_mm)});
    }
  }
  return glances;
}

SheetTracker::Sighting SheetTracker::lookForMarks(const FrameView& view, int unit,
                                                  const PlaneMotion& expected, double search_mm,
                                                  const std::optional<KeepOut>& spot,
                                                  std::span<const MarkGlance> glances) const {
  Sighting seen;
  for (std::size_t i = 0; i < print_.marks.size(); ++i) {
    const RegistrationMark& mark = print_.marks[i];
    const Eigen::Vector2d p_mm = expected * mark.p_SM_mm;
    if (!markInView(p_mm, mark.diameter_mm)) continue;
    const GrayImage* const part = view.around(calibration_.pixelFromPlane(p_mm));
    if (part == nullptr && !view.whole()) continue;  // Not read out in this frame.
    const bool covered = isCovered(p_mm, mark.diameter_mm, spot);
    std::optional<FoundMark> found;
    // Where it should be found for certain: not so near to the border that the prediction decides.
    const bool certain = markInView(p_mm, mark.diameter_mm + 2.0 * search_mm);
    seen.in_view += !covered && certain ? 1 : 0;
    if (!covered && part != nullptr) {
      const auto glance =
          std::ranges::find_if(glances, [&](const MarkGlance& g) { return g.unit == unit && g.mark == i; });
      if (glance != glances.end()) found = glance->found;
      // A glance may have looked too far off, or for a unit that has got another number since.
      if (!found || (found->p_mm - p_mm).norm() > search_mm)
        found = measured(*part, unit, i, p_mm, search_mm);
    }
    if (!found || (found->p_mm - p_mm).norm() > search_mm) continue;
    seen.pairs.push_back({mark.p_SM_mm, found->p_mm, found->sigma_mm});
    seen.marks.push_back(i);
    seen.diameters_mm.push_back(mark.diameter_mm);
    seen.levels.push_back(found->levels);
  }
  return seen;
}

std::vector<SheetPose> SheetTracker::measure(const FrameView& view, double time_s,
                                             const std::optional<KeepOut>& spot,
                                             std::span<const MarkGlance> glances) {
  std::vector<SheetPose> poses;
  if (units_.empty()) return poses;
  std::map<int, UnitState> measured;
  double contrast = 0.0;
  int contrasts = 0;
  const auto [first, last] = unitsToLookFor();
  for (int unit = first; unit <= last; ++unit) {
    const UnitState before = predict(unit, time_s);
    Sighting seen = lookForMarks(view, unit, before.motion, looseness(unit, time_s), spot, glances);
    for (std::size_t i = 0; i < seen.marks.size(); ++i) {
      const auto [known, is_new] = levels_.try_emplace({unit, seen.marks[i]}, seen.levels[i]);
      if (!is_new) known->second.average(seen.levels[i], kPooledMarks);
      contrast += seen.levels[i].contrast();
    }
    contrasts += static_cast<int>(seen.levels.size());
    if (seen.pairs.empty()) continue;
    poolNoise(seen.pairs, seen.diameters_mm);
    MotionFit fit = fitMotionRobust(seen.pairs, before.motion, kDisagreementMm);
    if (fit.pairs == 1) keepAngle(fit, seen.pairs, before.angle_variance);
    measured[unit] = {fit.motion, fit.covariance(2, 2), time_s};
    // A first mark alone gives a place but no direction; far from it the pose would be wrong by tenths of a
    // mm.
    angle_known_ = angle_known_ || fit.pairs > 1 || print_.marks.size() == 1;
    if (!angle_known_) continue;
    const auto moved = static_cast<int>(seen.pairs.size()) - fit.pairs;
    poses.push_back({unit, fit.motion.shift_mm, fit.motion.angle_rad, fit.rms_mm, fit.pairs, seen.in_view,
                     moved, fit.covariance, seen.marks});
  }
  if (contrasts > 0) contrast_gray_ = contrast / contrasts;
  keepUnits(measured, time_s);
  return poses;
}

/// The belt's speed comes from units that were seen in the frame before, too.
void SheetTracker::keepUnits(const std::map<int, UnitState>& measured, double time_s) {
  double moved = 0.0;
  double waited = 0.0;
  for (const auto& [unit, state] : measured) {
    const auto before = units_.find(unit);
    if (before == units_.end() || before->second.time_s != time_s_ || !(time_s > time_s_)) continue;
    moved += state.motion.shift_mm.x() - before->second.motion.shift_mm.x();
    waited += time_s - time_s_;
  }
  if (waited > 0.0) speed_mm_s_ += 0.5 * (moved / waited - speed_mm_s_);
  for (const auto& [unit, state] : measured) units_[unit] = state;
  // Units that have gone by are forgotten, but for the last one, to count on from.
  if (!measured.empty()) {
    std::erase_if(units_, [&](const auto& entry) { return entry.second.time_s != time_s; });
    std::erase_if(levels_, [&](const auto& entry) { return !units_.contains(entry.first.first); });
  }
  time_s_ = time_s;
}

int SheetTracker::explained(const std::vector<FoundMark>& seen,
                            const std::map<int, PlaneMotion>& poses) const {
  int n = 0;
  for (const FoundMark& mark : seen) {
    bool known = false;
    for (const auto& [unit, motion] : poses) {
      for (const RegistrationMark& m : print_.marks)
        known = known || (motion * m.p_SM_mm - mark.p_mm).norm() < 0.5;
    }
    n += known ? 1 : 0;
  }
  return n;
}

bool SheetTracker::lock(const std::vector<FoundMark>& seen, double time_s) {
  std::vector<Eigen::Vector2d> places;
  for (const FoundMark& mark : seen) places.push_back(mark.p_mm);
  if (places.empty()) return false;
  ConstellationQuery query;
  query.print = &print_;
  query.in_view = [this](const Eigen::Vector2d& p_mm) { return markInView(p_mm, largest_diameter_mm_); };
  if (units_.empty()) {
    // Unit 0 enters first, so one of the marks seen is its.
    query.anchor_last_unit = 0;
    query.last_unit = std::min(print_.units - 1, 3);
    query.max_shift_mm = std::numeric_limits<double>::infinity();
    query.prefer_least_advanced = true;
  } else {
    const int around = units_.rbegin()->first;
    query.first_unit = std::max(0, around - 2);
    query.last_unit = std::min(print_.units - 1, around + 2);
    query.anchor_last_unit = query.last_unit;
    query.expected = predict(0, time_s).motion;
    query.max_shift_mm = 0.4 * print_.pitch_mm;
  }
  const std::optional<Constellation> found = matchConstellation(places, query);
  if (!found) return false;
  // One lonely disc may be dirt unless the layout says that no other can be in view.
  const int needed = std::min(2, found->expected);
  if (found->matched < needed || 2 * found->matched < found->expected) return false;
  const double angle_variance = angleVarianceOf(seen, query.max_angle_rad);
  units_.clear();
  for (int unit = query.first_unit; unit <= query.last_unit; ++unit) {
    PlaneMotion motion = found->motion;
    motion.shift_mm -= motion.rotation() * Eigen::Vector2d(unit * print_.pitch_mm, 0.0);
    const bool visible =
        std::any_of(print_.marks.begin(), print_.marks.end(),
                    [&](const RegistrationMark& m) { return markInView(motion * m.p_SM_mm, m.diameter_mm); });
    if (visible) units_[unit] = {motion, angle_variance, time_s};
  }
  return !units_.empty();
}

std::vector<SheetPose> SheetTracker::step(const FrameView& view, double time_s,
                                          const std::optional<KeepOut>& spot,
                                          const std::vector<FoundMark>* all_marks,
                                          std::span<const MarkGlance> glances) {
  if (print_.marks.empty() || print_.units < 1) return {};
  if (units_.empty()) {
    if (all_marks == nullptr || !lock(*all_marks, time_s)) {
      time_s_ = time_s;
      return {};
    }
    return measure(view, time_s, spot, {});
  }
  const std::map<int, UnitState> before = units_;
  const double before_time_s = time_s_;
  const double before_speed_mm_s = speed_mm_s_;
  std::vector<SheetPose> poses = measure(view, time_s, spot, glances);
  if (all_marks == nullptr || all_marks->empty()) return poses;

  // Does what we believe explain what the full search saw? A false first sight is mended here.
  std::map<int, PlaneMotion> believed;
  for (const SheetPose& pose : poses) believed[pose.unit] = {pose.p_WS_mm, pose.angle_rad};
  const int known = explained(*all_marks, believed);
  const auto unknown = static_cast<int>(all_marks->size()) - known;
  const bool doubtful = known == 0 || (known == 1 && unknown >= 1);
  if (!doubtful) return poses;
  const std::map<int, UnitState> after = units_;
  const double after_speed_mm_s = speed_mm_s_;
  units_ = before;
  time_s_ = before_time_s;
  speed_mm_s_ = before_speed_mm_s;
  bool locked = lock(*all_marks, time_s);
  if (!locked && known == 0 && all_marks->size() >= 2 && poses.empty() && before.begin()->first == 0 &&
      before.size() == 1) {
    units_.clear();  // Perhaps what was followed never was a mark.
    locked = lock(*all_marks, time_s);
    if (!locked) units_ = before;
  }
  if (locked) {
    std::vector<SheetPose> again = measure(view, time_s, spot, {});
    int marks_now = 0;
    int marks_before = 0;
    for (const SheetPose& pose : again) marks_now += pose.marks;
    for (const SheetPose& pose : poses) marks_before += pose.marks;
    if (marks_now > marks_before) return again;
  }
  units_ = after;
  time_s_ = time_s;
  speed_mm_s_ = after_speed_mm_s;
  return poses;
}

}  // namespace kerfbench::vision
