// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/trace/trace_file.h"
#include "twin/scene/moving_scene.h"

namespace kerfbench::trace {

/// The machine of a trace at any moment, as the viewer shows it: parts moved by their joints, the beam, and
/// what was burnt. Labels are left out: a trace has none.
class TraceScenes {
 public:
  /// Reads the machine, its motion in a span and what was burnt until then; also of a trace that was cut off.
  /// @throws std::system_error, McapError if it is none or has no machine.
  explicit TraceScenes(const std::filesystem::path& trace, const TraceSpan& span = {});

  /// Time of the last row of motion in the span; 0: there is none.
  [[nodiscard]] double end_s() const { return rows_.empty() ? 0.0 : rows_.back().pose.time_s; }
  [[nodiscard]] const std::string& scenario() const { return scenario_; }
  /// Time between two units of the web; 0: the belt stands, or there is one unit alone.
  [[nodiscard]] double unitPeriod_s() const { return unit_period_s_; }

  /// The scene between the rows around a time. May be called by several threads. @throws std::logic_error if
  /// there is no motion.
  [[nodiscard]] twin::Scene at(double time_s) const;

 private:
  struct Row {
    twin::MachinePose pose;
    Eigen::Vector3d spot_W_mm{Eigen::Vector3d::Zero()};  ///< NaN: the beam misses the board.
    bool is_lit{};                                       ///< Since the row before.
  };
  struct Burnt {
    double time_s{};
    Eigen::Vector2d p_S_mm;
    bool begins{};
  };
  void takeMachine(std::string_view json);
  void takeMotion(std::string_view json, const TraceSpan& span);
  void takeBurnt(std::string_view json, const TraceSpan& span);
  [[nodiscard]] Row rowAt(double time_s) const;
  void addBeam(const Row& row, twin::Scene& scene) const;
  void addBurnt(const Row& row, twin::Scene& scene) const;

  twin::MovingScene moving_;
  std::string machine_, scenario_;
  double web_start_x_mm_{}, unit_period_s_{}, floor_z_mm_{};
  Eigen::AlignedBox3d sheet_;
  std::vector<Row> rows_;
  std::vector<Burnt> burnt_;
};

}  // namespace kerfbench::trace
