// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <memory>
#include <span>
#include <thread>

#include "hil/camera/frame_source.h"
#include "hil/camera/machine_cameras.h"
#include "hil/judge/beam_aim.h"
#include "hil/judge/wanted_span.h"
#include "hil/run/lockstep.h"
#include "hil/scenario/case.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/spot/spot_track.h"
#include "twin/base/pin_event.h"

namespace kerfbench::judge {

/// How long the spot camera is recorded before the laser works for the first time and after the last, s.
double recordMargin_s(const twin::CameraDescription& camera);
/// How the frames of a case are measured.
vision::SpotTrackOptions spotTrackOptions(const scenario::Case& test_case, vision::BeamAim aim, int threads);

/// The spot camera, looked at while the machine still runs: frames are rendered and measured by threads of
/// their own, as soon as pins and machine have got so far, and are not kept. The track is the same as that of
/// a look after the run.
class SpotWatch {
 public:
  /// Null if the spot is to be looked at afterwards: with one thread only, by a real camera, by one without
  /// calibration, by cameras that cannot, or not at all. To be called before the run; `test_case` must
  /// outlive it, and it the run.
  static std::unique_ptr<SpotWatch> of(const scenario::Case& test_case, camera::MachineCameras& cameras,
                                       TickRate rate, int threads);
  ~SpotWatch();
  SpotWatch(const SpotWatch&) = delete;
  SpotWatch& operator=(const SpotWatch&) = delete;

  /// The controller's events up to `until`, by tick; before the machine makes them. Waits while the
  /// measurement is far behind.
  void heard(Tick until, std::span<const PinEvent> events);
  /// The run has ended: waits for the rest. Once. @throws what measuring has thrown.
  vision::SpotTrack finished();

 private:
  SpotWatch(const scenario::Case& test_case, std::unique_ptr<camera::FramesMeanwhile> frames,
            vision::CameraCalibration calibration, evidence::ActiveLine gate, TickRate rate, int threads);
  void measure(int threads);

  const scenario::Case& test_case_;
  std::unique_ptr<camera::FramesMeanwhile> frames_;
  vision::CameraCalibration calibration_;
  WantedSpan wanted_;
  std::shared_ptr<SharedSteps> steps_;

  vision::SpotTrack track_;
  std::exception_ptr failure_;
  std::thread thread_;
};

/// Lets a watch hear a run; nobody if it is null. It must outlive the run.
run::Hearing heardBy(SpotWatch* watch);

}  // namespace kerfbench::judge
