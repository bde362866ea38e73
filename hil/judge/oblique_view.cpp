// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/oblique_view.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::judge {

double obliqueShift_mm(const vision::KerfScan& scan, const vision::CameraCalibration& calibration,
                       double thickness_mm) {
  const Eigen::Vector3d camera_mm = calibration.X_CP.inverse().translation();
  double steepest = 0.0;  // Tangent of the angle.
  for (const vision::EntityKerf& kerf : scan.entities) {
    for (const vision::Caliper& c : kerf.calipers) {
      if (c.found)
        steepest = std::max(steepest, (c.p_V_mm - camera_mm.head<2>()).norm() / std::abs(camera_mm.z()));
    }
  }
  return 0.5 * thickness_mm * steepest;
}

}  // namespace kerfbench::judge
