// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/png.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace kerfbench::hil {

std::vector<std::uint8_t> encodePng(const GrayImage& image) {
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    throw std::invalid_argument("encodePng: an image without pixels");
  }
  // OpenCV has no read-only Mat; imencode only reads.
  const cv::Mat mat(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", mat, bytes)) throw std::invalid_argument("encodePng: OpenCV refused the image");
  return bytes;
}

GrayImage decodeImage(std::span<const std::uint8_t> bytes) {
  const std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
  cv::Mat mat;
  try {
    if (!copy.empty()) mat = cv::imdecode(copy, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    mat.release();
  }
  if (mat.empty()) throw std::invalid_argument("decodeImage: not a picture that can be read");
  GrayImage image(mat.cols, mat.rows);
  for (int r = 0; r < mat.rows; ++r) {
    const std::uint8_t* const line = mat.ptr<std::uint8_t>(r);
    std::copy(line, line + mat.cols, image.row(r).begin());
  }
  return image;
}

}  // namespace kerfbench::hil
