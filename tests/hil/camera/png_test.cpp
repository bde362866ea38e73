// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/png.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace kerfbench::hil {
namespace {

TEST(Png, GivesBackEveryPixel) {
  GrayImage image(37, 23);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(i * 7);
  const std::vector<std::uint8_t> bytes = encodePng(image);
  ASSERT_GT(bytes.size(), 8U);
  EXPECT_EQ(bytes[1], 'P');
  EXPECT_EQ(encodePng(image), bytes);
  const GrayImage back = decodeImage(bytes);
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 23);
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST(Png, RefusesWhatIsNoPicture) {
  EXPECT_THROW(encodePng(GrayImage{}), std::invalid_argument);
  GrayImage torn(4, 4);
  torn.pixels.pop_back();
  EXPECT_THROW(encodePng(torn), std::invalid_argument);
  EXPECT_THROW(decodeImage({}), std::invalid_argument);
  const std::vector<std::uint8_t> noise{1, 2, 3, 4, 5};
  EXPECT_THROW(decodeImage(noise), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::hil
