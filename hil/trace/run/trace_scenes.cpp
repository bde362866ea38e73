// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/trace_scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "hil/trace/mcap_reader.h"
#include "hil/trace/run/moving_scene_json.h"

namespace kerfbench::trace {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Columns of a message by name.
class Columns {
 public:
  explicit Columns(std::string_view json) : json_(Json::parse(json)) {}
  [[nodiscard]] std::size_t rows() const { return json_.at("t_s").size(); }
  /// NaN: not known, or no such column.
  [[nodiscard]] double at(const std::string& name, std::size_t row) const {
    const auto column = json_.find(name);
    if (column == json_.end() || column->at(row).is_null()) return kNone;
    return column->at(row).get<double>();
  }

 private:
  Json json_;
};

double zeroIfNone(double value) { return std::isnan(value) ? 0.0 : value; }

Eigen::Vector2d between(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double share) {
  return a + share * (b - a);
}

twin::MachinePose between(const twin::MachinePose& a, const twin::MachinePose& b, double share) {
  return {std::lerp(a.time_s, b.time_s, share),
          std::lerp(a.roller_mm, b.roller_mm, share),
          std::lerp(a.belt_travel_mm, b.belt_travel_mm, share),
          between(a.sheet_slip_mm, b.sheet_slip_mm, share),
          between(a.frame_mm, b.frame_mm, share),
          between(a.gantry_mm, b.gantry_mm, share),
          between(a.mirror_rad, b.mirror_rad, share)};
}

/// Calls `take(topic, json)` for all messages that can be read; what is damaged is left out.
template <class Take>
void forEachMessage(const std::filesystem::path& path, Take take) {
  McapReader reader(path);
  McapDirectory directory;
  const auto within = [&](McapOp op, std::string_view content) {
    if (op == McapOp::kSchema || op == McapOp::kChannel) directory.take(op, content);
    if (op != McapOp::kMessage) return;
    const McapMessage message = readMcapMessage(content);
    const auto channel = directory.channels().find(message.channel);
    if (channel == directory.channels().end()) return;
    if (const auto topic = topicNamed(channel->second.topic)) take(*topic, message.data);
  };
  while (const auto record = reader.next()) {
    try {
      within(record->op, record->content);
      if (record->op == McapOp::kChunk) forEachRecord(chunkRecords(record->content), within);
    } catch (const McapError&) {
      continue;
    }
  }
}

}  // namespace

TraceScenes::TraceScenes(const std::filesystem::path& trace, const TraceSpan& span) {
  bool has_machine = false;
  try {
    forEachMessage(trace, [&](Topic topic, std::string_view json) {
      if (topic == Topic::kMachine) takeMachine(json);
      if (topic == Topic::kMotion) takeMotion(json, span);
      if (topic == Topic::kBurnt) takeBurnt(json, span);
      has_machine = has_machine || topic == Topic::kMachine;
    });
  } catch (const Json::exception& e) {
    throw McapError(fmt::format("{}: {}", trace.string(), e.what()));
  } catch (const std::out_of_range& e) {
    throw McapError(fmt::format("{}: {}", trace.string(), e.what()));
  }
  if (!has_machine) throw McapError(fmt::format("{} does not say what machine it is of", trace.string()));
  const auto time = [](const Row& row) { return row.pose.time_s; };
  std::ranges::stable_sort(rows_, {}, time);
  std::ranges::stable_sort(burnt_, {}, &Burnt::time_s);
}

void TraceScenes::takeMachine(std::string_view json) {
  const Json machine = Json::parse(json);
  moving_ = movingSceneFrom(machine);
  machine_ = machine.at("machine");
  scenario_ = machine.at("scenario");
  const Json& web = machine.at("web");
  web_start_x_mm_ = web.at("start_x_mm");
  const double belt_mm_s = machine.at("belt_mm_s");
  if (belt_mm_s > 0.0 && web.at("units").get<int>() > 1)
    unit_period_s_ = web.at("pitch_mm").get<double>() / belt_mm_s;
  const Json& sheet = machine.at("views").at("sheet");
  const auto corner = [](const Json& p) { return Eigen::Vector3d(p.at(0), p.at(1), p.at(2)); };
  sheet_ = Eigen::AlignedBox3d(corner(sheet.at("min_mm")), corner(sheet.at("max_mm")));
  floor_z_mm_ = moving_.overall.box_mm.min().z();
}

void TraceScenes::takeMotion(std::string_view json, const TraceSpan& span) {
  const Columns columns(json);
  for (std::size_t i = 0; i < columns.rows(); ++i) {
    const double time_s = columns.at("t_s", i);
    // The rows before and behind the span are those between which its ends lie.
    if (time_s > span.to_s + kBatch_s || time_s < span.from_s - kBatch_s) continue;
    const auto value = [&](const char* name) { return columns.at(name, i); };
    const auto pose = [&](const char* name) { return zeroIfNone(value(name)); };
    rows_.push_back({{time_s,
                      pose("roller_mm"),
                      pose("belt_mm"),
                      {pose("slip_x_mm"), pose("slip_y_mm")},
                      {pose("frame_x_mm"), pose("frame_y_mm")},
                      {pose("gantry_x_mm"), pose("gantry_y_mm")},
                      {pose("mirror_x_rad"), pose("mirror_y_rad")}},
                     {value("spot_x_mm"), value("spot_y_mm"), value("spot_z_mm")},
                     value("lit") > 0.5});
  }
}

void TraceScenes::takeBurnt(std::string_view json, const TraceSpan& span) {
  const Columns columns(json);
  for (std::size_t i = 0; i < columns.rows(); ++i) {
    const double time_s = columns.at("t_s", i);
    if (time_s <= span.to_s + kBurntSpan_s)
      burnt_.push_back(
          {time_s, {columns.at("x_mm", i), columns.at("y_mm", i)}, columns.at("start", i) > 0.5});
  }
}

TraceScenes::Row TraceScenes::rowAt(double time_s) const {
  if (rows_.empty()) throw std::logic_error("TraceScenes: nothing moved");
  const auto after = std::ranges::lower_bound(rows_, time_s, {}, [](const Row& r) { return r.pose.time_s; });
  if (after == rows_.begin()) return rows_.front();
  if (after == rows_.end()) return rows_.back();
  const Row& before = *std::prev(after);
  const double share = (time_s - before.pose.time_s) / (after->pose.time_s - before.pose.time_s);
  Row row = *after;
  row.pose = between(before.pose, after->pose, share);
  row.spot_W_mm = before.spot_W_mm + share * (after->spot_W_mm - before.spot_W_mm);
  return row;
}

void TraceScenes::addBeam(const Row& row, twin::Scene& scene) const {
  scene.beam_on = row.is_lit;
  if (!row.spot_W_mm.head<2>().allFinite()) return;
  const std::vector<Eigen::Vector3d> corners = twin::beamAt(moving_, row.pose);
  for (std::size_t i = 0; i < corners.size(); ++i)
    scene.beam.push_back({corners[i], moving_.beam.at(i).radius_mm});
  scene.beam.push_back(
      {{row.spot_W_mm.x(), row.spot_W_mm.y(), zeroIfNone(row.spot_W_mm.z())}, moving_.spot_radius_mm});
}

void TraceScenes::addBurnt(const Row& row, twin::Scene& scene) const {
  const Eigen::Vector2d web_mm =
      Eigen::Vector2d(web_start_x_mm_ + row.pose.belt_travel_mm, 0.0) + row.pose.sheet_slip_mm;
  std::vector<Eigen::Vector3d> line;
  const auto end = [&] {
    if (line.size() > 1) scene.burnt.push_back(line);
    line.clear();
  };
  const double low_mm = moving_.overall.box_mm.min().x();
  const double high_mm = moving_.overall.box_mm.max().x();
  for (std::size_t i = 0; i < burnt_.size(); ++i) {
    const Burnt& point = burnt_[i];
    Eigen::Vector2d p_mm = web_mm + point.p_S_mm;
    const bool is_under_way = point.time_s > row.pose.time_s;
    if (point.begins) end();
    if (is_under_way) {
      // The piece that is burnt right now is as long as it has got.
      if (!point.begins && i > 0 && burnt_[i - 1].time_s < row.pose.time_s) {
        const Burnt& from = burnt_[i - 1];
        p_mm = web_mm + between(from.p_S_mm, point.p_S_mm,
                                (row.pose.time_s - from.time_s) / (point.time_s - from.time_s));
      } else {
        break;
      }
    }
    if (p_mm.x() < low_mm || p_mm.x() > high_mm)
      end();
    else
      line.emplace_back(p_mm.x(), p_mm.y(), 0.0);
    if (is_under_way) break;
  }
  end();
}

twin::Scene TraceScenes::at(double time_s) const {
  const Row row = rowAt(time_s);
  twin::Scene scene;
  scene.machine = machine_;
  scene.time_s = row.pose.time_s;
  scene.parts = twin::partsAt(moving_, row.pose);
  addBeam(row, scene);
  addBurnt(row, scene);
  scene.floor_z_mm = floor_z_mm_;
  scene.overall = moving_.overall.box_mm;
  scene.sheet = sheet_;
  scene.head = moving_.head.box_mm;
  if (moving_.head.body >= 0) {
    const auto displacements = twin::displacementsAt(moving_, row.pose);
    scene.head.translate(displacements.at(static_cast<std::size_t>(moving_.head.body)).translation());
  }
  scene.head_view = moving_.head.look.isZero() ? Eigen::Vector3d::UnitY() : moving_.head.look;
  return scene;
}

}  // namespace kerfbench::trace
