// SPDX-License-Identifier: Apache-2.0
#include "player.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "firmware_under_test/controller/protocol.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner::test {
namespace {

using Eigen::Vector2d;

/// Place of the beam by Cheng et al. 2014, eq. 1.
Vector2d beamAt(const int* steps, const MachineParameters& m) {
  if (m.head == MachineParameters::Head::kGantry) {
    return {steps[KB_GANTRY_X] * m.gantry_step_mm, steps[KB_GANTRY_Y] * m.gantry_step_mm};
  }
  const double y = m.throw_mm * std::tan(2.0 * steps[KB_GALVO_Y] * m.mirror_step_rad);
  const double arm = std::sqrt(m.throw_mm * m.throw_mm + y * y) + m.mirror_spacing_mm;
  return {arm * std::tan(2.0 * steps[KB_GALVO_X] * m.mirror_step_rad), y};
}

}  // namespace

Played play(const Program& program, const MachineParameters& m, const JobParameters& job) {
  Played out;
  int steps[KB_AXES] = {};
  // Place x_W of unit 0's origin. With a print mark it is known from the first mark on.
  double web_x = job.feed_by_controller || job.belt_speed_mm_s == 0.0 ? job.web_start_x_mm : 0.0;
  bool belt_known = job.feed_by_controller || job.belt_speed_mm_s == 0.0;
  bool following = false;
  double gain = 0.0;
  for (const auto& op : program.ops) {
    if (out.ended) out.error = "operations after the end";
    if (op[0] == KB_OP_END) {
      out.ended = true;
    } else if (op[0] == KB_OP_WAIT_MARK) {
      std::int32_t offset = 0;
      for (unsigned i = 0; i < 4; ++i)
        offset |= static_cast<std::int32_t>(std::uint32_t(op[1 + i]) << (8 * i));
      // The mark's edge was under the sensor when unit k's origin was eye_mark_x upstream of it.
      const double unit_x = m.print_mark_sensor_x_mm - job.eye_mark_x_mm + offset * m.encoder_count_mm;
      const double at = unit_x + out.marks_waited * job.pitch_mm;
      if (belt_known && at < web_x - 1e-9) out.error = "the belt was already beyond the mark's offset";
      web_x = at;
      belt_known = true;
      ++out.marks_waited;
    } else if (op[0] == KB_OP_FOLLOW) {
      following = op[1] != 0;
    } else if ((op[0] & KB_OP_MOVE) != 0) {
      Period period;
      period.from_W_mm = beamAt(steps, m);
      std::size_t at = 1;
      int feed = 0;
      for (unsigned axis = 0; axis < KB_AXES; ++axis) {
        if ((op[0] & (1U << axis)) == 0) continue;
        const int count = static_cast<std::int8_t>(op[at++]);
        steps[axis] += count;
        period.largest_steps = std::max(period.largest_steps, std::abs(count));
        if (axis == KB_FEED) feed = count;
      }
      if ((op[0] & KB_OP_POWER) != 0) period.power = op[at++];
      if ((op[0] & KB_OP_GAIN) != 0) {
        gain = static_cast<std::int16_t>(op[at] | (op[at + 1] << 8)) / 4096.0;
        at += 2;
      }
      if (at != op.size()) out.error = "a move of wrong length";
      out.feed_steps += feed;
      period.to_W_mm = beamAt(steps, m);
      // The beam is where the steps put it one tracking delay later, so the sheet has gone on by that much.
      const double late = job.stop_and_go ? 0.0 : job.belt_speed_mm_s * m.tracking_delay_s;
      const double before = web_x;
      web_x +=
          job.feed_by_controller ? feed * m.feed_step_mm : job.belt_speed_mm_s * program.target.periodS();
      period.from_S_mm = period.from_W_mm - Vector2d(before + late, 0.0);
      period.to_S_mm = period.to_W_mm - Vector2d(web_x + late, 0.0);
      period.following = following;
      period.gain = gain;
      out.periods.push_back(period);
    } else {
      out.error = "unknown operation";
    }
  }
  return out;
}

MachineParameters twoMirror() {
  MachineParameters m;
  m.head = MachineParameters::Head::kTwoMirror;
  m.throw_mm = 500.0;
  m.mirror_spacing_mm = 15.0;
  m.mirror_step_rad = 12.5e-6;
  for (int i = 0; i < 2; ++i) m.field_min_mm[i] = -80.0, m.field_max_mm[i] = 80.0;
  m.tracking_delay_s = 0.19e-3;
  m.encoder_count_mm = 0.01;
  m.print_mark_sensor_x_mm = -150.0;
  m.full_power_w = 200.0;
  return m;
}

MachineParameters gantry() {
  MachineParameters m;
  m.head = MachineParameters::Head::kGantry;
  m.gantry_step_mm = 0.0125;
  m.field_min_mm[0] = -20.0, m.field_max_mm[0] = 760.0;
  m.field_min_mm[1] = -410.0, m.field_max_mm[1] = 410.0;
  m.encoder_count_mm = 0.01;
  m.print_mark_sensor_x_mm = -150.0;
  m.full_power_w = 400.0;
  return m;
}

JobParameters mirrorJob() {
  JobParameters j;
  j.cut_energy_j_per_mm = 0.5;
  return j;
}

JobParameters gantryJob() {
  JobParameters j;
  j.mark_speed_mm_s = 230.0;
  j.jump_speed_mm_s = 400.0;
  j.acceleration_mm_s2 = 2500.0;
  j.cut_energy_j_per_mm = 1.0;
  return j;
}

dieline::Entity line(double x0, double y0, double x1, double y1, dieline::Process process) {
  dieline::Entity entity;
  entity.curve = dieline::LineCurve{{x0, y0}, {x1, y1}};
  entity.process = process;
  return entity;
}

dieline::Entity arc(double cx, double cy, double r, double start_deg, double sweep_deg) {
  const double rad = std::numbers::pi / 180.0;
  dieline::Entity entity;
  entity.curve = dieline::ArcCurve{{cx, cy}, r, start_deg * rad, sweep_deg * rad};
  return entity;
}

dieline::Dieline dielineOf(std::vector<dieline::Entity> entities) {
  dieline::Dieline dieline;
  dieline.entities = std::move(entities);
  for (std::size_t i = 0; i < dieline.entities.size(); ++i) dieline.entities[i].id = static_cast<int>(i);
  return dieline;
}

dieline::Dieline label() {
  return dielineOf({line(-3, -20, -57, -20), arc(-57, -17, 3, 270, -90), line(-60, -17, -60, 17),
                    arc(-57, 17, 3, 180, -90), line(-57, 20, -3, 20), arc(-3, 17, 3, 90, -90),
                    line(0, 17, 0, -17), arc(-3, -17, 3, 0, -90)});
}

dieline::Dieline carton() {
  using dieline::Process;
  dieline::Entity window = arc(-70, 0, 8, 0, 360);
  dieline::Entity thumb;
  thumb.curve = dieline::BezierCurve{
      (Eigen::Matrix<double, 2, 4>() << 0.0, -12.0, -12.0, 0.0, -10.0, -10.0, 10.0, 10.0).finished(),
      Eigen::Vector4d::Ones()};
  return dielineOf(
      {line(0, -45, 0, -10), thumb, line(0, 10, 0, 45), line(0, 45, -20, 45), line(-20, 45, -24, 70),
       line(-24, 70, -58, 70), line(-58, 70, -62, 45), line(-62, 45, -142, 40), line(-142, 40, -142, -40),
       line(-142, -40, -62, -45), line(-62, -45, 0, -45), window, line(-110, -12, -110, 12),
       line(-20, -45, -20, 45, Process::kCrease), line(-62, -45, -62, 45, Process::kCrease),
       line(-20, 45, -62, 45, Process::kHalfCut), line(-125, -30, -125, 30, Process::kPerforation)});
}

CrossCut paperCut() { return {1200.0, 800.0, 780.0, 200.0, 230.0, 400.0}; }

dieline::Dieline strip() { return dielineOf({line(0, -400, 0, 400)}); }

namespace {
Vector2d inUnit(const Vector2d& p, const JobParameters& job, int unit) {
  return p + Vector2d(unit * job.pitch_mm, 0.0);
}
}  // namespace

double worstDeviationMm(const Played& played, const dieline::Dieline& dieline, const JobParameters& job) {
  double worst = 0.0;
  for (const Period& period : played.periods) {
    if (period.power < 0) continue;
    const Vector2d middle = 0.5 * (period.from_S_mm + period.to_S_mm);
    for (const Vector2d& p : {middle, period.to_S_mm}) {
      double best = std::numeric_limits<double>::infinity();
      for (int unit = 0; unit < job.units; ++unit) {
        const Vector2d q = inUnit(p, job, unit);
        if (job.units > 1 && std::abs(q.x() + 70.0) > 200.0) continue;
        for (const dieline::Entity& entity : dieline.entities) {
          best = std::min(best, dieline::nearestOn(entity.curve, q).distance_mm);
        }
      }
      worst = std::max(worst, best);
    }
  }
  return worst;
}

double worstGapMm(const Played& played, const dieline::Dieline& dieline, const JobParameters& job, int unit) {
  double worst = 0.0;
  for (const dieline::Entity& entity : dieline.entities) {
    if (entity.process == dieline::Process::kPerforation) continue;
    for (int i = 0; i <= 200; ++i) {
      const Vector2d p = dieline::pointAt(entity.curve, i / 200.0);
      double best = std::numeric_limits<double>::infinity();
      for (const Period& period : played.periods) {
        if (period.power < 0) continue;
        const Vector2d a = inUnit(period.from_S_mm, job, unit);
        const Vector2d ab = inUnit(period.to_S_mm, job, unit) - a;
        const double u =
            ab.squaredNorm() > 0.0 ? std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
        best = std::min(best, (p - a - u * ab).norm());
      }
      worst = std::max(worst, best);
    }
  }
  return worst;
}

}  // namespace kerfbench::planner::test
