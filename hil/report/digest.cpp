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

void addJoints(const std::vector<inspect::JointResult>& joints, Json& root) {
  for (const inspect::JointResult* j : sortedBy(joints, [](const inspect::JointResult& x) {
         return std::tuple(x.unit, x.entity, x.entity_out, x.kind, x.at_start, x.p_S_mm.x(), x.p_S_mm.y());
       })) {
    root["joints"].push_back(jointJson<Json>(*j));
  }
}

/// Where the sheet lay on the table and in each frame, and where the spot was.
void addPoses(const RunReport& report, Json& root) {
  for (const vision::UnitPose* u :
       sortedBy(report.kerf.units, [](const vision::UnitPose& x) { return x.unit; })) {
    root["units"].push_back({u->unit, rounded(u->p_TS_mm.x()), rounded(u->p_TS_mm.y()),
                             significant(u->angle_rad), covarianceJson(u->covariance), u->marks});
  }
  for (const vision::FrameMeasurement& frame : report.spot.frames) {
    Json j{frame.sequence, significant(frame.mid_s)};
    if (frame.spot_W_mm)
      j.push_back(
          {rounded(frame.spot_W_mm->x()), rounded(frame.spot_W_mm->y()), significant(frame.spot_sigma_mm)});
    for (const vision::SheetPose& pose : frame.sheet) {
      j.push_back({pose.unit, rounded(pose.p_WS_mm.x()), rounded(pose.p_WS_mm.y()),
                   significant(pose.angle_rad), covarianceJson(pose.covariance), pose.marks});
    }
    root["frames"].push_back(std::move(j));
  }
  root["frames_lost"] = report.spot.frames_lost;
}

}  // namespace

std::string digestOf(const RunReport& report) {
  const inspect::InspectionResult& result = report.result;
  Json root;
  root["verdict"] = inspect::verdictName(result.verdict);
  for (const std::string& problem : result.problems) root["problems"].push_back(withoutPaths(problem));
  for (const inspect::Check* c : sortedBy(result.checks, [](const inspect::Check& x) { return x.name; })) {
    root["checks"].push_back(checkJson<Json>(*c));
  }
  for (const inspect::Unjudged* u :
       sortedBy(result.unjudged, [](const inspect::Unjudged& x) { return x.name; }))
    root["not_judged"].push_back({u->name, u->applies, withoutPaths(u->reason)});
  for (const inspect::EntityResult* e : sortedBy(
           result.entities, [](const inspect::EntityResult& x) { return std::pair(x.unit, x.entity); })) {
    root["entities"].push_back(entityJson<Json>(*e));
  }
  for (const inspect::CutResult* c : sortedBy(result.cuts, [](const inspect::CutResult& x) {
         return std::tuple(x.start_s, x.unit, x.entity);
       })) {
    Json cut = cutJson<Json>(*c);
    cut["time_s"] = roundedAll(c->time_s);
    cut["residual_mm"] = roundedAll(c->residual_mm);
    root["cuts"].push_back(std::move(cut));
  }
  for (const vision::EntityKerf* k : sortedBy(
           report.kerf.entities, [](const vision::EntityKerf& x) { return std::pair(x.unit, x.entity); })) {
    root["kerf"].push_back(kerfJson(*k));
  }
  for (const vision::StrayCut* s : sortedBy(report.kerf.strays, [](const vision::StrayCut& x) {
         return std::tuple(x.unit, x.p_S_mm.x(), x.p_S_mm.y(), x.extent_mm);
       })) {
    root["strays"].push_back(
        {s->unit, rounded(s->p_S_mm.x()), rounded(s->p_S_mm.y()), rounded(s->extent_mm)});
  }
  for (const PulseTiming* t : sortedBy(report.pulses, [](const PulseTiming& x) { return x.axis; })) {
    Json pulse = pulseJson<Json>(*t);
    pulse["setup_histogram"] = t->setup_histogram;
    root["pulses"].push_back(std::move(pulse));
  }
  for (const EvidencePart* part : sortedBy(report.evidence, [](const EvidencePart& x) { return x.name; }))
    root["evidence"].push_back({part->name, part->sha256});
  addJoints(result.joints, root);
  for (const inspect::LayerResult* l :
       sortedBy(result.layers, [](const inspect::LayerResult& x) { return x.layer; }))
    root["layers"].push_back({l->layer, quantityJson<Json>(l->worst_mm), quantityJson<Json>(l->rms_mm)});
  root["rms_mm"] = quantityJson<Json>(result.rms_mm);
  addPoses(report, root);
  return base::sha256(root.dump());
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
  return base::sha256(root.dump());
}

}  // namespace kerfbench::report
