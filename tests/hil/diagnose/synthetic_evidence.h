// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>

#include "hil/diagnose/evidence.h"
#include "twin/base/random.h"

namespace kerfbench::test {

/// Evidence of a run without a fault: a frame of 50 mm x 30 mm with a line askew and a circle, cut on two
/// units of a web whose speed changes, or at rest. Noise by a seed.
class SyntheticEvidence {
 public:
  using Moves = std::function<Eigen::Vector2d(const diagnose::HeadState&, const diagnose::SheetState&)>;

  explicit SyntheticEvidence(bool moves = true, bool gantry = false) {
    out_.sheet_moves = moves;
    out_.failed = true;
    out_.planned_speed_mm_s = moves ? 30.0 : 0.0;
    out_.drawing_centre_mm = {-25.0, 0.0};
    out_.machine.gantry = gantry;
    out_.machine.encoder_count_mm = 0.01;
    if (gantry) {
      out_.machine.step_mm = {0.0125, 0.0125};
    } else {
      out_.machine.throw_mm = 500.0;
      out_.machine.spacing_mm = 15.0;
      out_.machine.mirror_step_urad = 12.5;
      out_.machine.step_mm = {0.012875, 0.0125};
      out_.machine.tracking_delay_s = 0.19e-3;
    }
    for (int unit = 0; unit < (moves ? 2 : 1); ++unit) {
      unit_ = unit;
      side(0, {0, -15}, {0, 15});
      side(1, {0, 15}, {-50, 15});
      side(2, {-50, 15}, {-50, -15});
      side(3, {-50, -15}, {0, -15});
      side(6, {-30, -10}, {-40, 8});
      side(7, {-40, 8}, {-30, -10});
      circle(4, {-12, 0}, 6.0);
      time_s_ += 2.0;
    }
  }

  diagnose::Evidence& evidence() { return out_; }

  /// The program is displaced, by the place in S from the drawing's middle.
  SyntheticEvidence& program(const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& by) {
    for (auto& line : out_.lines) {
      const double mm = by(line.p_S_mm - out_.drawing_centre_mm).dot(line.normal);
      line.program_mm += mm;
      line.asked_mm += mm;
      line.cut_mm += mm;
    }
    return *this;
  }
  SyntheticEvidence& controller(const Moves& by) {
    for (auto& line : out_.lines) {
      const double mm = by(line.head, line.sheet).dot(line.normal);
      line.asked_mm += mm;
      line.cut_mm += mm;
    }
    return *this;
  }
  SyntheticEvidence& machine(const Moves& by) {
    for (auto& line : out_.lines) line.cut_mm += by(line.head, line.sheet).dot(line.normal);
    for (auto& spot : out_.spots) spot.away_mm += by(spot.head, {});
    return *this;
  }

 private:
  double noise(double sigma_mm) { return sigma_mm * random_.normal(count_++); }

  void add(int entity, const Eigen::Vector2d& p_S, const Eigen::Vector2d& tangent, double speed_mm_s) {
    time_s_ += 2.0 / speed_mm_s;
    const double belt_mm_s = out_.sheet_moves ? 30.0 + 8.0 * std::sin(1.5 * time_s_) : 0.0;
    diagnose::LineReading line;
    line.unit = unit_;
    line.entity = entity;
    line.p_S_mm = p_S;
    line.normal = {-tangent.y(), tangent.x()};
    line.program_mm = 0.0;
    line.sheet.speed_mm_s = belt_mm_s;
    const double travel_mm = out_.sheet_moves ? 30.0 * time_s_ - 8.0 / 1.5 * std::cos(1.5 * time_s_) : 0.0;
    if (first_unit_ != unit_) {
      first_unit_ = unit_;
      begun_s_ = time_s_;
      begun_mm_ = travel_mm;
    }
    line.sheet.x_mm = 25.0 + (out_.sheet_moves ? travel_mm - begun_mm_ : 0.0);
    line.sheet.since_mark_mm = line.sheet.x_mm + 150.0;
    line.sheet.off_plan_mm = out_.sheet_moves ? travel_mm - begun_mm_ - 30.0 * (time_s_ - begun_s_) : 0.0;
    line.head.time_s = time_s_;
    line.head.p_mm = p_S + Eigen::Vector2d(line.sheet.x_mm, 0.0);
    line.head.v_mm_s = speed_mm_s * tangent + Eigen::Vector2d(belt_mm_s, 0.0);
    for (int axis = 0; axis < 2; ++axis) {
      const double way_mm = line.head.p_mm[axis] - before_mm_[axis];
      if (std::abs(way_mm) > 0.01) flank_[axis] = way_mm > 0.0 ? 1.0 : -1.0;
      forward_mm_[axis] += std::max(0.0, way_mm);
    }
    before_mm_ = line.head.p_mm;
    line.head.flank = flank_;
    line.head.forward_mm = forward_mm_;
    line.asked_mm = noise(0.003);
    line.cut_sigma_mm = 0.003;
    line.cut_mm = line.asked_mm + noise(0.004);
    out_.lines.push_back(line);
    for (int i = 0; i < 3; ++i) {
      diagnose::SpotReading spot;
      spot.unit = unit_;
      spot.head = line.head;
      spot.away_mm = {noise(0.008), noise(0.008)};
      spot.sigma_mm = 0.002;
      out_.spots.push_back(spot);
    }
  }
  void side(int entity, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d along = (to - from).normalized();
    for (double s = 1.0; s < (to - from).norm(); s += 2.0) add(entity, from + s * along, along, 100.0);
    time_s_ += 0.1;
  }
  void circle(int entity, const Eigen::Vector2d& centre, double radius) {
    for (double angle = 0.0; angle < 6.28; angle += 2.0 / radius) {
      const Eigen::Vector2d out(std::cos(angle), std::sin(angle));
      add(entity, centre + radius * out, {-out.y(), out.x()}, 60.0);
    }
  }

  diagnose::Evidence out_;
  CounterRandom random_{7, 1};
  std::uint64_t count_{};
  Eigen::Vector2d before_mm_{0, 0}, flank_{1, 1}, forward_mm_{0, 0};
  double time_s_{4.0}, begun_s_{}, begun_mm_{};
  int unit_{}, first_unit_{-1};
};

}  // namespace kerfbench::test
