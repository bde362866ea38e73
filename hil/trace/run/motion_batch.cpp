// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/motion_batch.h"

#include <utility>

namespace kerfbench::trace {

int decimalsOf(std::string_view column) {
  if (column.ends_with("_rad")) return kRad;
  if (column.ends_with("_w")) return kWatt;
  return column.ends_with("_s") ? kSeconds : kMm;
}

MotionBatch::MotionBatch(const std::vector<twin::PoseColumn>& columns) {
  for (const twin::PoseColumn column : columns) {
    const std::string_view name = twin::poseColumnName(column);
    pose_.push_back({std::string(name), decimalsOf(name), {}});
  }
}

void MotionBatch::add(const MotionRow& row) {
  if (rows_++ == 0) first_s_ = row.time_s;
  time_.add(row.time_s, kSeconds);
  for (std::size_t i = 0; i < pose_.size(); ++i) pose_[i].values.add(row.columns.at(i), pose_[i].decimals);
  spot_x_.add(row.spot_W_mm.x(), kMm);
  spot_y_.add(row.spot_W_mm.y(), kMm);
  spot_z_.add(row.spot_W_mm.z(), kMm);
  power_.add(row.power_w, kWatt);
  lit_.add(row.lit ? 1 : 0);
}

std::string MotionBatch::take() {
  std::string text = "{";
  appendColumn(text, "t_s", time_);
  for (Named& column : pose_) {
    appendColumn(text, column.name, column.values);
    column.values.clear();
  }
  for (const auto& [name, column] : {std::pair{"spot_x_mm", &spot_x_},
                                     {"spot_y_mm", &spot_y_},
                                     {"spot_z_mm", &spot_z_},
                                     {"power_w", &power_},
                                     {"lit", &lit_}}) {
    appendColumn(text, name, *column);
    column->clear();
  }
  time_.clear();
  text.push_back('}');
  rows_ = 0;
  return text;
}

}  // namespace kerfbench::trace
