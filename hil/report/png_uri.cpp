// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "hil/base/png_codec.h"
#include "hil/report/html_text.h"
#include "twin/base/image.h"

namespace kerfbench::report {

std::string pngDataUri(const GrayImage& image) {
  if (image.width <= 0 || image.height <= 0) return {};
  const std::vector<std::uint8_t> png =
      base::encodePng({image.width, image.height, 1, 8, image.pixels}, base::PngEffort::kSmall);
  return "data:image/png;base64," + base64({reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace kerfbench::report
