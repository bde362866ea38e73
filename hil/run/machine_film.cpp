// SPDX-License-Identifier: Apache-2.0
#include "hil/run/machine_film.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "twin/base/image.h"
#include "twin/cutter/twin.h"

namespace kerfbench::run {
namespace {

// A time that was asked for in decimals is that of the step it names, whichever way either was rounded.
constexpr double kRounding_s = 1e-9;

std::array<double, 2> pairOf(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }
Eigen::Vector2d vectorOf(const std::array<double, 2>& pair) { return {pair[0], pair[1]}; }

}  // namespace

void MachineFilm::add(const twin::Twin& twin) {
  const twin::Twin::Truth truth = twin.truth();
  const twin::MachinePose pose = twin.pose();
  Frame frame{pose.time_s,
              pose.roller_mm,
              pose.belt_travel_mm,
              pairOf(pose.sheet_slip_mm),
              pairOf(pose.frame_mm),
              pairOf(pose.gantry_mm),
              pairOf(pose.mirror_rad),
              pairOf(truth.p_WQ_mm),
              truth.emitted_j,
              false};
  if (!frames_.empty()) {
    const double elapsed_s = frame.time_s - frames_.back().time_s;
    if (!(elapsed_s > 0)) return;
    frame.lit = frame.emitted_j - frames_.back().emitted_j > lit_w_ * elapsed_s;
  }
  frames_.push_back(frame);
}

twin::MachinePose MachineFilm::poseOf(const Frame& frame) {
  return {frame.time_s,
          frame.roller_mm,
          frame.belt_travel_mm,
          vectorOf(frame.sheet_slip_mm),
          vectorOf(frame.frame_mm),
          vectorOf(frame.gantry_mm),
          vectorOf(frame.mirror_rad)};
}

std::size_t MachineFilm::indexAt(double time_s) const {
  if (frames_.empty()) throw std::logic_error("MachineFilm: nothing was filmed");
  const auto later =
      std::ranges::upper_bound(frames_, time_s + kRounding_s, {}, [](const Frame& f) { return f.time_s; });
  return later == frames_.begin() ? 0 : static_cast<std::size_t>(later - frames_.begin()) - 1;
}

// In the frame that moves with the sheet and is W at t = 0.
Eigen::Vector2d MachineFilm::spotOnBelt_mm(std::size_t index) const {
  const Frame& frame = frames_[index];
  return vectorOf(frame.p_WQ_mm) - Eigen::Vector2d(frame.belt_travel_mm, 0.0) - vectorOf(frame.sheet_slip_mm);
}

double MachineFilm::middleOfLongestCut_s() const {
  double longest_mm = 0.0;
  double middle_s = end_s();
  double length_mm = 0.0;
  double begin_s = 0.0;
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    const double way_mm = (spotOnBelt_mm(i) - spotOnBelt_mm(i - 1)).norm();
    if (!frames_[i].lit || !(way_mm >= 0)) {
      length_mm = 0.0;
      continue;
    }
    if (length_mm == 0.0) begin_s = frames_[i - 1].time_s;
    length_mm += way_mm;
    if (length_mm > longest_mm) {
      longest_mm = length_mm;
      middle_s = 0.5 * (begin_s + frames_[i].time_s);
    }
  }
  return middle_s;
}

twin::SceneContent MachineFilm::contentUpTo(std::size_t last, const twin::WebDescription& web,
                                            const Eigen::AlignedBox2d& unit_S_mm) const {
  twin::SceneContent content;
  content.unit_S_mm = unit_S_mm;
  content.beam_on = frames_[last].lit;
  const Eigen::Vector2d start_mm(web.start_x_mm, 0.0);
  std::vector<Eigen::Vector2d> path;
  for (std::size_t i = 1; i <= last; ++i) {
    const Eigen::Vector2d from = spotOnBelt_mm(i - 1) - start_mm;
    const Eigen::Vector2d to = spotOnBelt_mm(i) - start_mm;
    if (frames_[i].lit && from.allFinite() && to.allFinite()) {
      if (path.empty()) path.push_back(from);
      path.push_back(to);
    } else if (!path.empty()) {
      content.burnt_S_mm.push_back(std::move(path));
      path.clear();
    }
  }
  if (!path.empty()) content.burnt_S_mm.push_back(std::move(path));
  return content;
}

twin::Scene MachineFilm::sceneAt(double time_s, const twin::MachineDescription& machine,
                                 const twin::WebDescription& web,
                                 const Eigen::AlignedBox2d& unit_S_mm) const {
  const std::size_t last = indexAt(time_s);
  return twin::sceneOf(machine, web, poseOf(frames_[last]), contentUpTo(last, web, unit_S_mm));
}

twin::Scene MachineFilm::finishedSheet(const twin::MachineDescription& machine,
                                       const twin::WebDescription& web,
                                       const Eigen::AlignedBox2d& unit_S_mm) const {
  const std::size_t last = indexAt(end_s());
  twin::SceneContent content = contentUpTo(last, web, unit_S_mm);
  content.beam_on = false;
  Eigen::AlignedBox2d burnt_S_mm;
  for (const auto& path : content.burnt_S_mm) {
    for (const Eigen::Vector2d& p : path) burnt_S_mm.extend(p);
  }
  twin::MachinePose pose = poseOf(frames_[last]);
  pose.sheet_slip_mm.setZero();
  const auto& field = machine.controller;
  const double middle_x_mm = 0.5 * (field.field_min_mm[0] + field.field_max_mm[0]);
  if (!burnt_S_mm.isEmpty()) pose.belt_travel_mm = middle_x_mm - burnt_S_mm.center().x() - web.start_x_mm;
  return twin::sceneOf(machine, web, pose, content);
}

}  // namespace kerfbench::run
