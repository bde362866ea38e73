// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "hil/source/vcd.h"

namespace kerfbench::source {

/// The reference controller's pins for the signals used here.
inline SignalMap sampleMap() {
  SignalMap map;
  map.assign(Signal::kGalvoXPul, {0, 0});
  map.assign(Signal::kGalvoXDir, {0, 1});
  map.assign(Signal::kGalvoYPul, {0, 2});
  map.assign(Signal::kLaserGate, {2, 2});
  map.assign(Signal::kEncoderA, {3, 2});
  map.assign(Signal::kPrintMark, {3, 3});
  return map;
}

/// Pulses on both axes at once, gate and sensors between, all from a fixed generator.
inline PinRecording sampleRecording(std::size_t pulses, TickRate rate = {1, 16'000'000}) {
  PinRecording recording;
  recording.rate = rate;
  std::uint64_t state = 7;
  const auto random = [&state](std::uint64_t below) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (state >> 33U) % below;
  };
  Tick tick = 0;
  std::uint16_t a = 0;
  const auto port_a = [&](std::uint16_t level) {
    if (level == a) return;
    recording.outputs.push_back({tick, 0, static_cast<std::uint16_t>(a ^ level), level, 0});
    a = level;
  };
  bool gate = false;
  bool encoder = false;
  for (std::size_t i = 0; i < pulses; ++i) {
    tick += 100 + random(500);
    const auto dir = static_cast<std::uint16_t>(random(2) << 1U);
    port_a(dir);
    tick += 80;
    port_a(static_cast<std::uint16_t>(dir | 1U | random(2) << 2U));
    if (random(5) == 0) {
      gate = !gate;
      recording.outputs.push_back({tick, 2, 4, static_cast<std::uint16_t>(gate ? 4 : 0), 0});
    }
    tick += 48;
    if (random(3) == 0) {
      encoder = !encoder;
      recording.sensors.push_back({tick - random(2), Signal::kEncoderA, encoder});
    }
    port_a(dir);
  }
  recording.end = tick + 1;
  return recording;
}

inline bool sameSensors(const base::SpilledVector<SensorEdge>& a, const base::SpilledVector<SensorEdge>& b) {
  return std::ranges::equal(a, b, [](const SensorEdge& x, const SensorEdge& y) {
    return x.tick == y.tick && x.signal == y.signal && x.level == y.level;
  });
}

class VcdTest : public ::testing::Test {
 public:
  [[nodiscard]] static std::filesystem::path file(const std::string& name) {
    return std::filesystem::path(::testing::TempDir()) / ("kerfbench-" + name);
  }
  [[nodiscard]] static std::string contentOf(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// A folder in memory for what only a test wants large, where there is one: no disk has to take it.
  static std::filesystem::path roomyFolder() {
    const std::filesystem::path shared = "/dev/shm";
    std::error_code none;
    return std::filesystem::space(shared, none).available / 2 > std::uintmax_t{1} << 30U && !none
               ? shared
               : std::filesystem::path(::testing::TempDir());
  }
  static std::filesystem::path put(const std::string& name, const std::string& content) {
    const auto path = file(name);
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
};

}  // namespace kerfbench::source
