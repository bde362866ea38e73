// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/picture_file.h"

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "hil/base/input_file.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/png.h"

namespace kerfbench::camera {

GrayImage readPicture(const std::filesystem::path& path) {
  const base::InputContent content = base::readInput(path, base::kLargestPicture_bytes);
  if (!content.bytes) throw base::ConfigError(path.string() + ": " + content.refusal);
  try {
    return decodeImage({reinterpret_cast<const std::uint8_t*>(content.bytes->data()), content.bytes->size()});
  } catch (const std::invalid_argument&) {
    throw base::ConfigError(path.string() + ": is no picture that can be read");
  }
}

}  // namespace kerfbench::camera
