// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/calibrate_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_file.h"
#include "hil/base/terminal.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/camera/residual_map.h"
#include "hil/calibrate/camera/target_print.h"
#include "hil/calibrate/files/calibration_file.h"
#include "hil/calibrate/files/target_file.h"
#include "hil/camera/png.h"
#include "hil/camera/twin/views/twin_views.h"
#include "hil/machine_file/machine_file.h"
#include "hil/scenario/camera_files.h"
#include "twin/base/image.h"

namespace kerfbench::instrument {
namespace {

namespace fs = std::filesystem;

/// The camera that is meant, and what the machine file says of it.
struct Chosen {
  machine_file::MachineFile machine;
  const twin::CameraDescription* camera{};
  const machine_file::CameraFile* file{};
};

Chosen choose(const CalibrateOptions& options) {
  Chosen chosen{machine_file::readMachineFile(options.machine)};
  const bool spot = options.camera == "spot";
  chosen.camera = spot ? &chosen.machine.machine.spot_camera : &chosen.machine.machine.kerf_camera;
  chosen.file = spot ? &chosen.machine.spot_camera : &chosen.machine.kerf_camera;
  return chosen;
}

std::vector<fs::path> pictureFiles(const std::vector<fs::path>& named) {
  std::vector<fs::path> files;
  for (const fs::path& path : named) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<fs::path> inside;
    for (const auto& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file() && entry.path().extension() == ".png") inside.push_back(entry.path());
    }
    std::ranges::sort(inside);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

GrayImage readPicture(const fs::path& path) {
  const base::InputContent content = base::readInput(path, base::kLargestPicture_bytes);
  if (!content.bytes) throw std::invalid_argument(content.refusal);
  try {
    return camera::decodeImage(
        {reinterpret_cast<const std::uint8_t*>(content.bytes->data()), content.bytes->size()});
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument("is no picture that can be read");
  }
}

void setViews(const CalibrateOptions& options, const Chosen& chosen, calibrate::CalibrationJob& job) {
  const calibrate::CalibrationTarget target =
      options.target.empty() ? camera::targetOf(*chosen.camera) : calibrate::readTarget(options.target);
  if (options.views.empty()) {
    camera::setTwinViews(*chosen.camera, camera::twinViews(*chosen.camera, target, options.tilted),
                         options.seed, job);
    return;
  }
  job.target = target;
  job.place = {{options.origin_mm.at(0), options.origin_mm.at(1)},
               std::numbers::pi / 180.0 * options.turn_deg};
  job.width_px = chosen.camera->width_px;
  job.height_px = chosen.camera->height_px;
  job.telecentric_mm = chosen.camera->telecentric_mm;
  const std::vector<fs::path> files = pictureFiles(options.views);
  for (const fs::path& file : files) job.views.push_back(file.filename().string());
  job.picture = [files](std::size_t v) { return readPicture(files.at(v)); };
}

/// The same wherever the program runs: file names without their folders.
std::string madeBy(const CalibrateOptions& options) {
  std::string text = fmt::format("kerfbench calibrate camera --machine {} --camera {} --date {}",
                                 options.machine.filename().string(), options.camera, options.date);
  if (options.views.empty()) {
    text += fmt::format(" --seed {}", options.seed);
    if (options.tilted != CalibrateOptions{}.tilted) text += fmt::format(" --tilted {}", options.tilted);
  } else {
    text += fmt::format(" --views … --origin-mm {:g} {:g} --turn-deg {:g}", options.origin_mm[0],
                        options.origin_mm[1], options.turn_deg);
  }
  if (!options.target.empty()) text += " --target " + options.target.filename().string();
  return text;
}

void saveViews(const calibrate::CalibrationJob& job, const CalibrateOptions& options) {
  fs::create_directories(options.save_views);
  for (std::size_t v = 0; v < job.views.size(); ++v) {
    const std::vector<std::uint8_t> png = camera::encodePng(job.picture(v));
    base::writeFileAtomically(options.save_views / fmt::format("view-{:02}.png", v),
                              {reinterpret_cast<const char*>(png.data()), png.size()});
  }
  base::writeFileAtomically(options.save_views / "target.yaml", calibrate::targetText(job.target));
}

fs::path placeOf(const CalibrateOptions& options, const machine_file::CameraFile& named) {
  if (!options.out.empty()) return options.out;
  if (named.named_here) return named.calibration;
  // Inherited from another machine file, which needs its own.
  return options.machine.parent_path() /
         fmt::format("{}.{}.camera.yaml", options.machine.stem().string(), options.camera);
}

void tell(const calibrate::CameraCalibrationResult& result, base::Console& console) {
  const vision::CameraCalibration& c = result.calibration;
  for (const calibrate::CalibratedView& view : result.views) {
    console.say(fmt::format("  {}: {} corners, {:.4f} px per axis, tilt {:.1f}°, blur {:.2f} px", view.name,
                            view.corners.size(), view.sigma_px, 180.0 / std::numbers::pi * view.tilt_rad,
                            view.blur_px));
  }
  console.say(fmt::format(
      "  focal {:.3f} {:.3f} px, centre {:.3f} {:.3f} px, distortion {:.6g} {:.6g} {:.6g} {:.6g} {:.6g}",
      c.fx_px, c.fy_px, c.cx_px, c.cy_px, c.distortion[0], c.distortion[1], c.distortion[2], c.distortion[3],
      c.distortion[4]));
  if (c.telecentric_mm > 0.0) {
    console.say(fmt::format("  telecentric, square to the plane within {:.3f}° (95 %)",
                            180.0 / std::numbers::pi * c.square_within_rad));
  }
  console.say(fmt::format("  covers x {:.2f} … {:.2f} mm, y {:.2f} … {:.2f} mm; {} of {} corners left out",
                          c.area_mm.min().x(), c.area_mm.max().x(), c.area_mm.min().y(), c.area_mm.max().y(),
                          result.outliers, result.corners + result.outliers));
  console.result(fmt::format("{}: residual {:.4f} px, largest standard uncertainty of the map {:.3f} um",
                             c.camera_id, c.rms_px, 1e3 * c.map_u_mm));
}

int refused(const std::string& why) {
  base::toTerminal(stderr, why + "\n");
  return base::kExitInput;
}

int calibrate(const CalibrateOptions& options) {
  base::Console console(options.quiet);
  const Chosen chosen = choose(options);
  calibrate::CalibrationJob job;
  job.camera_id = chosen.file->id;
  job.date = options.date;
  job.max_rms_px = options.max_rms_px;
  job.threads = options.jobs;
  setViews(options, chosen, job);
  if (!options.save_views.empty() && options.views.empty()) saveViews(job, options);
  console.say(fmt::format("camera {} of {}: {} views of a target of {} x {} squares of {:g} mm",
                          job.camera_id, options.machine.string(), job.views.size(), job.target.columns,
                          job.target.rows, job.target.square_mm));
  console.say(fmt::format("  in the first view it lies at --origin-mm {} {} --turn-deg {}",
                          job.place.p_PB_mm.x(), job.place.p_PB_mm.y(),
                          180.0 / std::numbers::pi * job.place.turn_rad));
  std::size_t done = 0;
  job.done = [&](std::size_t) {
    console.progress(-1, fmt::format("measuring the views: {} of {}", ++done, job.views.size()));
  };
  const calibrate::CameraCalibrationResult result = calibrate::calibrateCamera(job);

  const calibrate::CalibrationFile file{result.calibration, scenario::cameraFingerprint(*chosen.camera),
                                        result.views.size(), result.corners};
  const fs::path out = placeOf(options, *chosen.file);
  const fs::path picture =
      options.picture.empty()
          ? fs::path(fmt::format("{}.{}.residuals.svg", options.machine.stem().string(), options.camera))
          : options.picture;
  base::writeFileAtomically(picture, calibrate::residualMapSvg(result));
  base::writeFileAtomically(out, calibrate::calibrationText(file, madeBy(options)));
  tell(result, console);
  console.say(fmt::format("residual map: {}", picture.string()));
  console.say(fmt::format("calibration: {}", out.string()));
  std::error_code missing;
  if (!fs::equivalent(out, chosen.file->calibration, missing)) {
    console.say(fmt::format(
        "the machine file looks for {}; to use this one, give it cameras: {{{}: {{calibration: {}}}}}",
        chosen.file->calibration.string(), options.camera, out.filename().string()));
  }
  return 0;
}

}  // namespace

int calibrateCameraCommand(const CalibrateOptions& options) {
  try {
    return calibrate(options);
  } catch (const base::ConfigError& e) {
    return refused(e.what());
  } catch (const calibrate::CalibrationError& e) {
    return refused(fmt::format("{}\nno calibration is written", e.what()));
  }
}

int calibrateTargetCommand(const CalibrateOptions& options) {
  try {
    calibrate::CalibrationTarget target;
    if (!options.machine.empty()) target = camera::targetOf(*choose(options).camera);
    if (options.columns > 0) target.columns = options.columns;
    if (options.rows > 0) target.rows = options.rows;
    if (options.square_mm > 0.0) {
      target.square_mm = options.square_mm;
      target.marker_mm = 0.6 * options.square_mm;
    }
    if (const std::string faults = target.faults(); !faults.empty()) return refused("target: " + faults);
    fs::path description = options.out;
    description.replace_extension(".yaml");
    base::writeFileAtomically(options.out, calibrate::targetSvg(target));
    base::writeFileAtomically(description, calibrate::targetText(target));
    base::Console(options.quiet)
        .say(fmt::format(
            "{}: {} x {} squares of {:g} mm, {:g} x {:g} mm in all; print at 100 %, measure it, correct {}",
            options.out.string(), target.columns, target.rows, target.square_mm, target.size_mm().x(),
            target.size_mm().y(), description.string()));
    return 0;
  } catch (const base::ConfigError& e) {
    return refused(e.what());
  }
}

}  // namespace kerfbench::instrument
