// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/camera/tile_source.h"
#include "hil/dieline/process.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "twin/base/print_layout.h"

namespace kerfbench::vision {

KerfScan scanKerf(camera::TileSource& tiles, const CameraCalibration& calibration, const PrintLayout& print,
                  const dieline::Dieline& dieline, const KerfScanOptions& options);

}  // namespace kerfbench::vision
