// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tests/guest/film.h"
#include "twin/base/image.h"

namespace kerfbench::guest {

/// A picture that shows its number: every byte follows from it.
GrayImage numberedImage(int width_px, int height_px, std::uint32_t number);

/// One picture of a camera.
struct Exposure {
  std::uint64_t at_ns{};  ///< Time after the start.
  std::uint32_t number{};
};
/// Pictures with numbers first … last, one each period.
std::vector<Exposure> exposures(std::uint32_t first, std::uint32_t last, std::uint64_t period_ns);

/// Writing side of a v4l2loopback device, 8-bit grey, ready for readers from the start.
class LoopWriter {
 public:
  /// Opens the device. @throws std::system_error with path and call.
  LoopWriter(const std::string& path, int width_px, int height_px, std::uint32_t rate_hz);
  ~LoopWriter();
  LoopWriter(const LoopWriter&) = delete;
  LoopWriter& operator=(const LoopWriter&) = delete;

  void write(std::uint32_t number);
  /// Writes a picture of another size than was agreed on.
  void write(const GrayImage& image);
  void write(std::span<const std::uint8_t> pixels);
  /// Writes these pictures in time.
  void run(const std::vector<Exposure>& exposures);
  /// Writes a film; the first picture now.
  void play(const Film& film);

 private:
  std::string path_;
  int width_px_;
  int height_px_;
  int fd_;
};

}  // namespace kerfbench::guest
