// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "hil/report/html_text.h"

namespace kerfbench::report {

std::string pngDataUri(const GrayImage& image) {
  if (image.width <= 0 || image.height <= 0) return {};
  const cv::Mat pixels(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", pixels, png, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
    throw std::runtime_error("cannot encode a picture as PNG");
  }
  return "data:image/png;base64," + base64({reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace kerfbench::report
