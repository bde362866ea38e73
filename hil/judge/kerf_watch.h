// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <memory>
#include <thread>

#include "hil/camera/machine_cameras.h"
#include "hil/camera/tile_source.h"
#include "hil/scenario/case.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::judge {

/// How the kerf of a case is measured.
vision::KerfScanOptions kerfScanOptions(const scenario::Case& test_case,
                                        const vision::CameraCalibration& calibration, int threads);

/// The kerf camera, looked at while the machine still runs: each unit is photographed and measured when it
/// has left the machine, and then is neither kept as web nor as pictures. The scan is the same as that of a
/// look after the run.
class KerfWatch {
 public:
  /// Null if the cut is to be looked at afterwards: in pictures of a real camera, by one without calibration,
  /// by a camera that cannot, or not at all. With one thread all of it is measured in finished(). To be
  /// called before the run; `test_case` and `cameras` must outlive it, and it the run.
  static std::unique_ptr<KerfWatch> of(const scenario::Case& test_case, camera::MachineCameras& cameras,
                                       int threads);
  ~KerfWatch();
  KerfWatch(const KerfWatch&) = delete;
  KerfWatch& operator=(const KerfWatch&) = delete;

  /// The run has ended: waits for the rest. Once. @throws what measuring has thrown.
  vision::KerfScan finished();

 private:
  KerfWatch(const scenario::Case& test_case, std::unique_ptr<camera::TilesMeanwhile> tiles,
            vision::CameraCalibration calibration, int threads);
  void measure();

  const scenario::Case& test_case_;
  std::unique_ptr<camera::TilesMeanwhile> tiles_;
  vision::CameraCalibration calibration_;
  int threads_;

  vision::KerfScan scan_;
  std::exception_ptr failure_;
  std::thread thread_;  ///< None with one thread.
};

}  // namespace kerfbench::judge
