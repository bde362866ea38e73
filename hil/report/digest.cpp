// SPDX-License-Identifier: Apache-2.0
// Digests: of what was measured and judged, and of what it was made from.
#include "hil/base/digest.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/report/json_parts.h"
#include "hil/report/run_report.h"

namespace kerfbench::report {
namespace {

Json roundedAll(const std::vector<double>& values) {
  Json array = Json::array();
  for (const double v : values) array.push_back(rounded(v));
  return array;
}

template <typename T, typename Key>
std::vector<const T*> sortedBy(const std::vector<T>& items, Key key) {
  std::vector<const T*> pointers;
  for (const T& item : items) pointers.push_back(&item);
  std::stable_sort(pointers.begin(), pointers.end(),
                   [&](const T* a, const T* b) { return key(*a) < key(*b); });
  return pointers;
}

/// Six digits, for uncertainties, which may be far below 1e-6.
Json significant(double value) {
  if (!std::isfinite(value)) return nullptr;
  return fmt::format("{:.6g}", value + 0.0);
}

Json covarianceJson(const Eigen::Matrix3d& c) {
  return {significant(c(0, 0)), significant(c(1, 1)), significant(c(2, 2)),
          significant(c(0, 1)), significant(c(0, 2)), significant(c(1, 2))};
}

/// A sentence with its file names taken out: they differ from machine to machine.
std::string withoutPaths(const std::string& sentence) {
  std::string out;
  for (std::size_t at = 0; at < sentence.size();) {
    const std::size_t end = std::min(sentence.find(' ', at), sentence.size());
    const std::string word = sentence.substr(at, end - at);
    out += word.find('/') == std::string::npos ? word : "/";
    if (end < sentence.size()) out += ' ';
    at = end + 1;
  }
  return out;
}

Json kerfJson(const vision::EntityKerf& kerf) {
  Json calipers = Json::array();
  for (const vision::Caliper& c : kerf.calipers) {
    calipers.push_back({rounded(c.station_mm), c.found, rounded(c.offset_mm), rounded(c.width_mm),
                        rounded(c.brightness), c.near_joint, significant(c.sigma_mm),
                        significant(c.steady_sigma_mm), significant(c.width_sigma_mm)});
  }
  Json light = Json::array();
  for (const vision::LightReading& r : kerf.light)
    light.push_back({rounded(r.station_mm), rounded(r.brightness), r.near_joint});
  return {{"unit", kerf.unit},
          {"entity", kerf.entity},
          {"calipers", std::move(calipers)},
          {"light", std::move(light)},
          {"widening_mm", rounded(kerf.widening_mm)},
          {"widening_sigma_mm", significant(kerf.widening_sigma_mm)},
          {"walls_sigma_mm", significant(kerf.walls_sigma_mm)},
          {"depth_mm", rounded(kerf.depth_mm)},
          {"depth_sigma_mm", significant(kerf.depth_sigma_mm)}};
}

Json poseJson(const vision::UnitPose& u) {
  return {u.unit,
          rounded(u.p_TS_mm.x()),
          rounded(u.p_TS_mm.y()),
          significant(u.angle_rad),
          covarianceJson(u.covariance),
          u.marks};
}

/// Where the sheet lay in a frame, and where the spot was.
Json frameJson(const vision::FrameMeasurement& frame) {
  Json j{frame.sequence, significant(frame.mid_s)};
  if (frame.spot_W_mm)
    j.push_back(
        {rounded(frame.spot_W_mm->x()), rounded(frame.spot_W_mm->y()), significant(frame.spot_sigma_mm)});
  for (const vision::SheetPose& pose : frame.sheet) {
    j.push_back({pose.unit, rounded(pose.p_WS_mm.x()), rounded(pose.p_WS_mm.y()), significant(pose.angle_rad),
                 covarianceJson(pose.covariance), pose.marks});
  }
  return j;
}

Json wholeCutJson(const inspect::CutResult& c) {
  Json cut = cutJson<Json>(c);
  cut["time_s"] = roundedAll(c.time_s);
  cut["residual_mm"] = roundedAll(c.residual_mm);
  return cut;
}

Json strayJson(const vision::StrayCut& s) {
  return {s.unit, rounded(s.p_S_mm.x()), rounded(s.p_S_mm.y()), rounded(s.extent_mm)};
}

Json wholePulseJson(const PulseTiming& t) {
  Json pulse = pulseJson<Json>(t);
  pulse["setup_histogram"] = t.setup_histogram;
  return pulse;
}

/// Bytes that are not UTF-8, of a layer's name for one, are U+FFFD.
std::string written(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// The sum of a JSON object as Json::dump() would write it, member by member: a long run's would fill memory.
class SumOfObject {
 public:
  /// Adds a member. Names ascend.
  void add(const char* name, const Json& value) {
    begin(name);
    sum_.add(written(value));
  }
  /// Adds a list, if there is anything in it; `items` are pointers.
  template <typename Items, typename ToJson>
  void addList(const char* name, const Items& items, const ToJson& toJson) {
    if (items.empty()) return;
    begin(name);
    const char* separator = "[";
    for (const auto& item : items) {
      sum_.add(separator + written(toJson(*item)));
      separator = ",";
    }
    sum_.add("]");
  }
  [[nodiscard]] std::string digest() {
    sum_.add("}");
    return sum_.digest();
  }

 private:
  void begin(const char* name) {
    sum_.add(separator_ + written(name) + ":");
    separator_ = ",";
  }

  base::Sha256 sum_;
  std::string separator_{"{"};
};

template <typename T>
std::vector<const T*> pointersTo(const std::vector<T>& items) {
  return sortedBy(items, [](const T&) { return 0; });
}

}  // namespace

std::string digestOf(const RunReport& report) {
  const inspect::InspectionResult& result = report.result;
  SumOfObject sum;
  sum.addList("checks", sortedBy(result.checks, [](const inspect::Check& x) { return x.name; }),
              checkJson<Json>);
  sum.addList("cuts",
              sortedBy(result.cuts,
                       [](const inspect::CutResult& x) { return std::tuple(x.start_s, x.unit, x.entity); }),
              wholeCutJson);
  sum.addList(
      "entities",
      sortedBy(result.entities, [](const inspect::EntityResult& x) { return std::pair(x.unit, x.entity); }),
      entityJson<Json>);
  sum.addList("evidence", sortedBy(report.evidence, [](const EvidencePart& x) { return x.name; }),
              [](const EvidencePart& part) {
                return Json{part.name, part.sha256};
              });
  sum.addList("frames", pointersTo(report.spot.frames), frameJson);
  sum.add("frames_lost", report.spot.frames_lost);
  sum.addList("joints",
              sortedBy(result.joints,
                       [](const inspect::JointResult& x) {
                         return std::tuple(x.unit, x.entity, x.entity_out, x.kind, x.at_start, x.p_S_mm.x(),
                                           x.p_S_mm.y());
                       }),
              jointJson<Json>);
  sum.addList(
      "kerf",
      sortedBy(report.kerf.entities, [](const vision::EntityKerf& x) { return std::pair(x.unit, x.entity); }),
      kerfJson);
  sum.addList("layers", sortedBy(result.layers, [](const inspect::LayerResult& x) { return x.layer; }),
              [](const inspect::LayerResult& l) {
                return Json{l.layer, quantityJson<Json>(l.worst_mm), quantityJson<Json>(l.rms_mm)};
              });
  sum.addList("not_judged", sortedBy(result.unjudged, [](const inspect::Unjudged& x) { return x.name; }),
              [](const inspect::Unjudged& u) {
                return Json{u.name, u.applies, withoutPaths(u.reason)};
              });
  sum.addList("problems", pointersTo(result.problems), withoutPaths);
  sum.addList("pulses", sortedBy(report.pulses, [](const PulseTiming& x) { return x.axis; }), wholePulseJson);
  sum.add("rms_mm", quantityJson<Json>(result.rms_mm));
  sum.addList("strays",
              sortedBy(report.kerf.strays,
                       [](const vision::StrayCut& x) {
                         return std::tuple(x.unit, x.p_S_mm.x(), x.p_S_mm.y(), x.extent_mm);
                       }),
              strayJson);
  sum.addList("units", sortedBy(report.kerf.units, [](const vision::UnitPose& x) { return x.unit; }),
              poseJson);
  sum.add("verdict", inspect::verdictName(result.verdict));
  return sum.digest();
}

std::string inputsDigestOf(const RunReport& report) {
  Json root;
  std::vector<std::string> files;
  for (const InputFile& input : report.inputs) files.push_back(input.sha256);
  std::ranges::sort(files);
  root["files"] = files;
  root["seed"] = report.seed;
  root["twin"] = report.model.twin;
  root["imperfections"] = report.model.imperfections;
  return base::sha256(written(root));
}

}  // namespace kerfbench::report
