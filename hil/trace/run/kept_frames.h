// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "hil/base/spilled_vector.h"
#include "twin/base/image.h"

namespace kerfbench::trace {

/// Some frames of the spot camera as messages of /frames, in a temporary file when they are many.
class KeptFrames {
 public:
  /// Every `every`th is kept; 0: none. Size of the camera's whole picture.
  KeptFrames(int every, int width_px, int height_px)
      : every_(every), width_px_(width_px), height_px_(height_px) {}

  /// From any thread.
  void add(const Frame& frame);
  /// Hands out the messages by time and sequence.
  void forEach(const std::function<void(std::uint64_t time_ns, std::string_view json)>& take) const;

 private:
  struct Entry {
    std::uint64_t time_ns{}, sequence{};
    std::size_t offset{}, size{};
  };
  void keep(const Frame& frame, const GrayImage& image);

  int every_, width_px_, height_px_;
  mutable std::mutex mutex_;
  base::SpilledVector<char> text_;
  std::vector<Entry> entries_;
};

}  // namespace kerfbench::trace
