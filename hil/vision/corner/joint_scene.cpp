// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/joint_scene.h"

namespace kerfbench::vision {

const TileView* JointScene::tileFor(const Eigen::Vector2d& p_S_mm, double reach_mm) const {
  const double border_px = (reach_mm + 0.1) / calibration->pitchMm() * 1.05 + 4.0;
  return tiles->best(*X_TS * p_S_mm, border_px);
}

double JointScene::boardAt(const TileView& view, const Eigen::Vector2d& p_S_mm) const {
  const Eigen::Vector2d pixel = calibration->pixelFromPlane(*X_TS * p_S_mm - view.tile.p_TV_mm);
  return view.background->at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())) / view.light.at(pixel);
}

const Station& JointScene::stationAt(const EntityEnd& end) const {
  const std::vector<Station>& stations = plan->entities[end.plan].stations;
  return end.at_start ? stations.front() : stations.back();
}

double JointScene::stationOf(const EntityEnd& end) const {
  return end.at_start ? 0.0 : plan->entities[end.plan].length_mm;
}

}  // namespace kerfbench::vision
