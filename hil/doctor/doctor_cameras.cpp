// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/doctor_cameras.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace kerfbench::doctor {
namespace {

using Grade = DoctorFinding::Grade;
using Json = nlohmann::ordered_json;

bool has(const camera::SizeListing& size, int width_px, int height_px) {
  const auto fits = [](int value, int least, int most, int step) {
    return value >= least && value <= most && (step <= 0 || (value - least) % step == 0);
  };
  return fits(width_px, size.width_px, size.max_width_px, size.step_width_px) &&
         fits(height_px, size.height_px, size.max_height_px, size.step_height_px);
}

bool has(const camera::SizeListing& size, double rate_hz) {
  constexpr double kRounding = 1.01;
  return size.intervals.empty() ||
         std::ranges::any_of(size.intervals, [&](const camera::IntervalListing& interval) {
           return rate_hz * interval.shortest_s <= kRounding &&
                  rate_hz * interval.longest_s >= 1.0 / kRounding;
         });
}

/// What a device lacks of a choice, each with file and line.
class Needs {
 public:
  Needs(const scenario::SpotCameraChoice& choice, const camera::CameraListing& camera,
        std::vector<DoctorFinding>& findings)
      : choice_(choice), camera_(camera), findings_(findings) {}

  void look(int width_px, int height_px) {
    const auto format = std::ranges::find(
        camera_.formats, camera::fourccText(choice_.settings.format->fourcc), &camera::FormatListing::fourcc);
    if (format == camera_.formats.end()) {
      std::string offered;
      for (const camera::FormatListing& one : camera_.formats)
        offered += (offered.empty() ? "" : ", ") + one.fourcc;
      missing("format", fmt::format("has no {}, it offers {}", choice_.settings.format->name, offered));
    } else {
      lookAtSize(*format, width_px, height_px);
    }
    if (choice_.settings.exposure_s)
      needControl("exposure_s", {"exposure_time_absolute", "exposure_absolute"});
    if (choice_.settings.gain) needControl("gain", {"gain", "analogue_gain"});
    for (const camera::CameraSettings::Control& control : choice_.settings.controls)
      needControl(control.key, {control.key});
  }

 private:
  void missing(const std::string& setting, const std::string& words) {
    const auto place = choice_.places.find(setting);
    findings_.push_back(
        {Grade::kMissing,
         fmt::format("{}: {} {}", place == choice_.places.end() ? choice_.place : place->second, camera_.path,
                     words)});
  }

  void lookAtSize(const camera::FormatListing& format, int width_px, int height_px) {
    // Drivers without a list, and windows, which no list has: only the driver itself knows.
    if (format.sizes.empty() || choice_.settings.window) return;
    const auto size = std::ranges::find_if(
        format.sizes, [&](const camera::SizeListing& s) { return has(s, width_px, height_px); });
    if (size == format.sizes.end()) {
      missing("size", fmt::format("gives no {} x {} in {}, the size that the machine file says", width_px,
                                  height_px, format.fourcc));
    } else if (choice_.settings.frame_rate_hz && !has(*size, *choice_.settings.frame_rate_hz)) {
      missing("frame_rate_hz", fmt::format("gives no {:g} frames/s at {} x {}",
                                           *choice_.settings.frame_rate_hz, width_px, height_px));
    }
  }

  void needControl(const std::string& setting, std::initializer_list<std::string> keys) {
    const bool is_there = std::ranges::any_of(camera_.controls, [&](const camera::ControlListing& control) {
      return std::ranges::find(keys, control.key) != keys.end();
    });
    if (!is_there) missing(setting, fmt::format("has no control {}", *keys.begin()));
  }

  const scenario::SpotCameraChoice& choice_;
  const camera::CameraListing& camera_;
  std::vector<DoctorFinding>& findings_;
};

Json sizeJson(const camera::SizeListing& size) {
  Json rates = Json::array();
  for (const camera::IntervalListing& interval : size.intervals)
    rates.push_back({{"shortest_s", interval.shortest_s}, {"longest_s", interval.longest_s}});
  return {{"size_px", {size.width_px, size.height_px}},
          {"max_size_px", {size.max_width_px, size.max_height_px}},
          {"intervals", std::move(rates)}};
}

}  // namespace

void addCameraFindings(const std::vector<camera::CameraListing>& cameras,
                       std::vector<DoctorFinding>& findings) {
  bool is_one = false;
  for (const camera::CameraListing& camera : cameras) {
    is_one = is_one || camera.captures;
    if (!camera.problem.empty()) findings.push_back({Grade::kTrouble, camera.path + ": " + camera.problem});
    const bool is_readable = std::ranges::any_of(camera.formats, &camera::FormatListing::is_readable);
    if (camera.captures && camera.problem.empty() && !is_readable)
      findings.push_back({Grade::kTrouble, camera.path + ": gives pictures in no format that can be read"});
  }
  if (!is_one &&
      std::ranges::all_of(cameras, [](const camera::CameraListing& c) { return c.problem.empty(); }))
    findings.push_back(
        {Grade::kNote, "no camera: scenarios with a real one (cameras.spot, source: v4l2) cannot run here"});
}

void addCameraNeeds(const scenario::Case& test_case, const std::vector<camera::CameraListing>& cameras,
                    std::vector<DoctorFinding>& findings) {
  const scenario::SpotCameraChoice& choice = test_case.scenario.cameras.spot;
  if (!choice.is_real) return;
  const std::size_t before = findings.size();
  std::string path;
  try {
    path = scenario::findCamera(choice, cameras);
  } catch (const base::ConfigError& error) {
    findings.push_back({Grade::kMissing, error.what()});
    return;
  }
  const auto camera = std::ranges::find(cameras, path, &camera::CameraListing::path);
  if (camera == cameras.end()) {
    findings.push_back({Grade::kMissing, fmt::format("{}: there is no {}", choice.place, path)});
  } else if (!camera->problem.empty() || !camera->captures) {
    findings.push_back(
        {Grade::kMissing,
         fmt::format("{}: {}: {}", choice.place, path,
                     camera->problem.empty() ? "gives no pictures by streaming" : camera->problem)});
  } else {
    Needs(choice, *camera, findings)
        .look(test_case.machine.spot_camera.width_px, test_case.machine.spot_camera.height_px);
  }
  if (findings.size() == before)
    findings.push_back(
        {Grade::kGood, fmt::format("{} ({}) has what the spot camera needs", path, camera->card)});
}

Json camerasJson(const std::vector<camera::CameraListing>& cameras) {
  Json list = Json::array();
  for (const camera::CameraListing& camera : cameras) {
    Json formats = Json::array();
    for (const camera::FormatListing& format : camera.formats) {
      Json sizes = Json::array();
      for (const camera::SizeListing& size : format.sizes) sizes.push_back(sizeJson(size));
      formats.push_back({{"fourcc", format.fourcc},
                         {"readable", format.is_readable},
                         {"cost", format.cost},
                         {"sizes", std::move(sizes)}});
    }
    Json controls = Json::array();
    for (const camera::ControlListing& control : camera.controls) {
      Json one{{"key", control.key},   {"min", control.min},          {"max", control.max},
               {"step", control.step}, {"default", control.fallback}, {"locked", control.is_locked}};
      if (control.has_value) one["value"] = control.value;
      controls.push_back(std::move(one));
    }
    list.push_back({{"path", camera.path},
                    {"card", camera.card},
                    {"driver", camera.driver},
                    {"bus", camera.bus},
                    {"problem", camera.problem},
                    {"captures", camera.captures},
                    {"formats", std::move(formats)},
                    {"controls", std::move(controls)}});
  }
  return list;
}

}  // namespace kerfbench::doctor
