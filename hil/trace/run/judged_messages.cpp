// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/judged_messages.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "hil/inspect/inspect.h"
#include "hil/inspect/verdict/verdict.h"
#include "hil/trace/json_text.h"
#include "hil/trace/topics.h"
#include "hil/vision/spot/spot_track.h"

namespace kerfbench::trace {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSameFrame_s = 1e-9;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What the judge found of one frame.
struct Followed {
  double time_s{};
  int unit{-1}, entity{-1};
  double deviation_mm{kNaN};
};

std::vector<Followed> followedOf(const inspect::InspectionResult& result) {
  std::vector<Followed> all;
  for (const inspect::CutResult& cut : result.cuts)
    for (const inspect::CutFrame& frame : cut.track)
      all.push_back({frame.time_s, cut.unit, frame.entity, frame.deviation_mm});
  std::ranges::stable_sort(all, {}, &Followed::time_s);
  return all;
}

Followed followedAt(const std::vector<Followed>& all, double time_s) {
  const auto found = std::ranges::lower_bound(all, time_s - kSameFrame_s, {}, &Followed::time_s);
  return found != all.end() && found->time_s <= time_s + kSameFrame_s ? *found : Followed{time_s};
}

/// Pose of the unit that was cut; of the first that was seen while none was.
const vision::SheetPose* poseOfUnit(const vision::FrameMeasurement& frame, int unit) {
  if (frame.sheet.empty()) return nullptr;
  if (unit < 0) return &frame.sheet.front();
  const auto found = std::ranges::find(frame.sheet, unit, &vision::SheetPose::unit);
  return found == frame.sheet.end() ? nullptr : &*found;
}

class SpotBatch {
 public:
  using Pixel = std::function<Eigen::Vector2d(const Eigen::Vector2d& p_W_mm)>;
  void add(const vision::FrameMeasurement& frame, const Followed& followed, const Pixel& pixel) {
    const Eigen::Vector2d seen_px =
        pixel && frame.spot_W_mm ? pixel(*frame.spot_W_mm) : Eigen::Vector2d::Constant(kNaN);
    x_px_.add(seen_px.x(), kPixel);
    y_px_.add(seen_px.y(), kPixel);
    const auto [x, y] =
        frame.spot_W_mm ? std::pair(frame.spot_W_mm->x(), frame.spot_W_mm->y()) : std::pair(kNaN, kNaN);
    const vision::SheetPose* const pose = poseOfUnit(frame, followed.unit);
    time_.add(frame.mid_s, kSeconds);
    x_.add(x, kMm);
    y_.add(y, kMm);
    sigma_.add(frame.spot_W_mm ? frame.spot_sigma_mm : kNaN, kSigma);
    sheet_x_.add(pose != nullptr ? pose->p_WS_mm.x() : kNaN, kMm);
    sheet_y_.add(pose != nullptr ? pose->p_WS_mm.y() : kNaN, kMm);
    sheet_rad_.add(pose != nullptr ? pose->angle_rad : kNaN, kRad);
    unit_.add(followed.unit < 0 && pose != nullptr ? pose->unit : followed.unit);
    entity_.add(followed.entity);
    deviation_.add(followed.deviation_mm, kMm);
  }
  [[nodiscard]] bool empty() const { return time_.empty(); }
  std::string take() {
    std::string text = "{";
    for (const auto& [name, column] : {std::pair{"t_s", &time_},
                                       {"x_mm", &x_},
                                       {"y_mm", &y_},
                                       {"sigma_mm", &sigma_},
                                       {"sheet_x_mm", &sheet_x_},
                                       {"sheet_y_mm", &sheet_y_},
                                       {"sheet_rad", &sheet_rad_},
                                       {"unit", &unit_},
                                       {"entity", &entity_},
                                       {"deviation_mm", &deviation_},
                                       {"x_px", &x_px_},
                                       {"y_px", &y_px_}}) {
      appendColumn(text, name, *column);
      column->clear();
    }
    text.push_back('}');
    return text;
  }

 private:
  static constexpr int kSigma = 5, kPixel = 2;
  JsonColumn time_, x_, y_, sigma_, sheet_x_, sheet_y_, sheet_rad_, unit_, entity_, deviation_, x_px_, y_px_;
};

}  // namespace

void spotMessages(const report::RunReport& report,
                  const std::function<Eigen::Vector2d(const Eigen::Vector2d& p_W_mm)>& pixel,
                  const TakeMessage& take) {
  const std::vector<Followed> followed = followedOf(report.result);
  SpotBatch batch;
  double first_s = 0.0;
  for (const vision::FrameMeasurement& frame : report.spot.frames) {
    if (!batch.empty() && frame.mid_s - first_s >= kBatch_s) take(first_s, batch.take());
    if (batch.empty()) first_s = frame.mid_s;
    batch.add(frame, followedAt(followed, frame.mid_s), pixel);
  }
  if (!batch.empty()) take(first_s, batch.take());
}

void checkMessages(const report::RunReport& report, const TakeMessage& take) {
  // A number that is none becomes null.
  for (const inspect::Check& check : report.result.checks) {
    const inspect::Whereabouts& where = check.where;
    const Json json{{"name", check.name},
                    {"title", check.title},
                    {"outcome", inspect::verdictName(check.verdict)},
                    {"value", check.value},
                    {"limit", check.limit},
                    {"upper", check.upper},
                    {"u", check.u},
                    {"unit", check.unit},
                    {"subject", check.subject},
                    {"sentence", check.explanation},
                    {"time_s", where.time_s},
                    {"within_s", where.within_s},
                    {"sheet_unit", where.unit},
                    {"entity", where.entity},
                    {"x_mm", where.x_mm},
                    {"y_mm", where.y_mm}};
    const bool has_moment = where.hasTime() && where.time_s >= 0.0 && where.time_s <= report.virtual_s;
    take(has_moment ? where.time_s : report.virtual_s,
         json.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
}

}  // namespace kerfbench::trace
