// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/camera_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <system_error>

#include <fmt/format.h>

#include "hil/base/add_to_list.h"
#include "hil/base/number_from.h"
#include "hil/camera/v4l2/pixel_format.h"
#include "twin/base/image.h"

namespace kerfbench::scenario {
namespace {

namespace fs = std::filesystem;

/// What a driver rounds a setting by without its being another one.
constexpr double kSameSetting = 0.01;

std::string settingPlace(const base::YamlReader& camera, const std::string& whole) {
  return camera.placeOf(whole) + ": " + whole;
}

void readFormat(base::YamlReader& spot, SpotCameraChoice& choice) {
  const std::string name = spot.text("format");
  choice.settings.format = camera::findPixelFormat(std::string_view(name));
  if (choice.settings.format == nullptr && !name.empty()) {
    std::string known;
    for (const camera::PixelFormat& format : camera::pixelFormats())
      base::addToList(known, format.name, ", ");
    spot.fault("format", fmt::format("'{}' cannot be read; known are {}", name, known));
  }
  choice.settings.bits = static_cast<int>(spot.integer("bits", {.min = 0, .max = 16, .fallback = 0.0}));
}

void readWindow(base::YamlReader& spot, SpotCameraChoice& choice) {
  if (!spot.has("window_px")) return;
  constexpr double kMost = 32768;
  const auto window = spot.numbers("window_px", 4, {.min = 0, .max = kMost});
  const auto whole = [](double value) { return static_cast<int>(value); };
  choice.settings.window =
      PixelWindow{whole(window[0]), whole(window[1]), whole(window[2]), whole(window[3])};
  if (choice.settings.window->empty())
    spot.fault("window_px", "has no pixel: say first column, first row, columns and rows");
}

void readControls(base::YamlReader& spot, SpotCameraChoice& choice) {
  for (const auto& [key, text] : spot.pairs("controls")) {
    const auto value = base::numberFrom<std::int32_t>(text);
    if (!value) spot.fault("controls", fmt::format("{}: '{}' is no whole number", key, text));
    choice.settings.controls.push_back({key, value.value_or(0)});
    choice.places[key] = settingPlace(spot, "cameras.spot.controls." + key);
  }
}

void readTimes(base::YamlReader& spot, SpotCameraChoice& choice) {
  constexpr double kLong_us = 1e7;
  if (spot.has("exposure_us"))
    choice.settings.exposure_s = 1e-6 * spot.number("exposure_us", {.min = 1, .max = kLong_us});
  if (spot.has("lit_us")) choice.lit_s = 1e-6 * spot.number("lit_us", {.min = 0.1, .max = kLong_us});
  if (!spot.has("exposure_us") && !spot.has("lit_us"))
    spot.fault("exposure_us",
               "say it, or with lit_us how long light falls on a frame of a camera without that setting");
  if (choice.settings.exposure_s && choice.lit_s > *choice.settings.exposure_s)
    spot.fault("lit_us", "is longer than the exposure");
  if (choice.lit_s == 0.0) choice.lit_s = choice.settings.exposure_s.value_or(0.0);
  choice.stamp_jitter_s = 1e-6 * spot.number("stamp_jitter_us", {.min = 0, .max = 1e5, .fallback = 50.0});
  choice.light_error_s = 1e-6 * spot.number("light_error_us", {.min = 0, .max = 1e5, .fallback = 100.0});
  choice.max_clock_s = 1e-6 * spot.number("clock_us", {.min = 1, .max = 1e6, .fallback = 2000.0});
}

SpotCameraChoice readSpot(base::YamlReader spot) {
  SpotCameraChoice choice;
  choice.is_real = spot.choice("source", {"twin", "v4l2"}, "twin") == "v4l2";
  if (!choice.is_real) return choice;
  choice.device = spot.text("device");
  choice.place = settingPlace(spot, "cameras.spot.device");
  readFormat(spot, choice);
  readWindow(spot, choice);
  readTimes(spot, choice);
  if (spot.has("frames_per_s"))
    choice.settings.frame_rate_hz = spot.number("frames_per_s", {.min = 0.1, .max = 1e5});
  if (spot.has("gain"))
    choice.settings.gain = static_cast<std::int32_t>(spot.integer("gain", {.min = -1e9, .max = 1e9}));
  readControls(spot, choice);
  choice.is_triggered = spot.boolean("triggered", false);
  choice.sensor_has_noise = spot.boolean("sensor_has_noise", true);
  for (const auto& [setting, key] : {std::pair{"format", "format"},
                                     {"bits", "bits"},
                                     {"window", "window_px"},
                                     {"exposure_s", "exposure_us"},
                                     {"frame_rate_hz", "frames_per_s"},
                                     {"gain", "gain"}})
    choice.places[setting] = settingPlace(spot, std::string("cameras.spot.") + key);
  return choice;
}

KerfCameraChoice readKerf(base::YamlReader kerf) {
  KerfCameraChoice choice;
  if (kerf.choice("source", {"twin", "tiles"}, "twin") != "tiles") return choice;
  choice.tiles = fs::absolute(kerf.folderOf("folder") / kerf.text("folder")).lexically_normal();
  choice.place = settingPlace(kerf, "cameras.kerf.folder");
  if (kerf.has("folder") && !fs::is_directory(choice.tiles))
    kerf.fault("folder", fmt::format("there is no folder {}", choice.tiles.string()));
  return choice;
}

std::string whatThereIs(std::span<const camera::CameraListing> cameras) {
  std::string text;
  for (const camera::CameraListing& camera : cameras) {
    if (!camera.captures && camera.problem.empty()) continue;
    text += fmt::format("{}{} ({})", text.empty() ? "there is " : ", ", camera.path,
                        camera.card.empty() ? camera.problem : camera.card + ", " + camera.bus);
  }
  return text.empty() ? "there is no camera at all" : text;
}

std::string placeOfSetting(const SpotCameraChoice& choice, const std::string& setting) {
  const auto place = choice.places.find(setting);
  return place == choice.places.end() ? choice.place + ": " + setting : place->second;
}

}  // namespace

CameraChoice readCameraChoice(base::YamlReader cameras) {
  CameraChoice choice;
  choice.spot = readSpot(cameras.section("spot"));
  // Kerf of a model with a real spot: only on purpose.
  if (choice.spot.is_real && !cameras.has("kerf"))
    cameras.fault(
        "spot",
        "is real: say as well where the kerf's pictures come from, kerf: {source: tiles, folder: …} or, "
        "if no real sheet is cut, {source: twin}");
  choice.kerf = readKerf(cameras.section("kerf"));
  return choice;
}

std::string findCamera(const SpotCameraChoice& choice, std::span<const camera::CameraListing> cameras) {
  if (choice.device.starts_with('/')) {
    std::error_code none;  // A udev link, say; what cannot be resolved cannot be opened either, and says why.
    const fs::path path = fs::canonical(choice.device, none);
    return none ? choice.device : path.string();
  }
  std::vector<std::string> found;
  for (const camera::CameraListing& camera : cameras) {
    if (camera.captures && (camera.card == choice.device || camera.bus == choice.device))
      found.push_back(camera.path);
  }
  if (found.size() == 1) return found.front();
  if (found.empty())
    throw base::ConfigError(
        fmt::format("{}: there is no camera '{}'; {}", choice.place, choice.device, whatThereIs(cameras)));
  throw base::ConfigError(
      fmt::format("{}: {} cameras are '{}', the first are {} and {}: name the bus or the path", choice.place,
                  found.size(), choice.device, found[0], found[1]));
}

std::string faultsOf(const SpotCameraChoice& choice, std::span<const camera::SettingFault> faults) {
  std::string text;
  for (const camera::SettingFault& fault : faults)
    base::addToList(text, placeOfSetting(choice, fault.setting) + ": " + fault.words);
  return text;
}

std::string faultsOf(const SpotCameraChoice& choice, const camera::CameraSetup& setup) {
  std::string text;
  for (const camera::SettingOutcome& one : setup.outcomes) {
    if (std::abs(one.got - one.wanted) <= kSameSetting * std::abs(one.wanted)) continue;
    base::addToList(text, fmt::format("{}: {} = {:g} was asked for, and the camera made {:g} of it",
                                      placeOfSetting(choice, one.setting), one.setting, one.wanted, one.got));
  }
  return text;
}

}  // namespace kerfbench::scenario
