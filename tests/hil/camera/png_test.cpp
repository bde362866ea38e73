// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/png.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "hil/base/png_codec.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
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

class DeepPng : public testing::TestWithParam<int> {};

TEST_P(DeepPng, GivesBackEveryLevelAndTheDepth) {
  const int bits = GetParam();
  std::vector<std::uint16_t> levels;
  for (int i = 0; i < 64 * 64; ++i) levels.push_back(static_cast<std::uint16_t>(i % (1 << bits)));
  const GrayImage image = GrayImage::ofLevels(64, 64, bits, levels);
  const GrayImage back = decodeImage(encodePng(image));
  EXPECT_EQ(back.bits, bits);
  EXPECT_EQ(back.width, 64);
  EXPECT_EQ(back.levels, levels);
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST_P(DeepPng, SpansTheWholeRangeForOtherReaders) {
  const auto white = static_cast<std::uint16_t>((1 << GetParam()) - 1);
  const auto bytes = encodePng(GrayImage::ofLevels(2, 1, GetParam(), {white, 0}));
  const auto picture = base::decodePng(bytes, base::PngColours::kGrey);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->bits, 16);
  EXPECT_EQ(picture->bytes, (std::vector<std::uint8_t>{0xff, 0xff, 0, 0}));
}

INSTANTIATE_TEST_SUITE_P(Bits, DeepPng, testing::Values(10, 12));

TEST(Png, ReadsSixteenBitsFromElsewhereAsTwelve) {
  const std::vector<std::uint16_t> levels{65535, 0x1230};
  std::vector<std::uint8_t> samples(4);
  std::memcpy(samples.data(), levels.data(), samples.size());
  const GrayImage image = decodeImage(base::encodePng({2, 1, 1, 16, samples}, base::PngEffort::kQuick));
  EXPECT_EQ(image.bits, 12);
  EXPECT_EQ(image.levels, (std::vector<std::uint16_t>{4095, 0x123}));
}

TEST(GrayImage, TellsGrayInUnitsOfTheEightBitScale) {
  const GrayImage twelve = GrayImage::ofLevels(3, 1, 12, {16 * 100 + 8, 16 * 100 + 7, 4095});
  EXPECT_EQ(twelve.gray(0, 0), 100.5);
  EXPECT_EQ(twelve.gray(2, 0), 256.0 - 1.0 / 16.0);
  EXPECT_EQ(twelve.pixels, (std::vector<std::uint8_t>{101, 100, 255}));
  EXPECT_EQ(GrayImage(2, 2, 77).gray(1, 1), 77.0);
  EXPECT_THROW(GrayImage::ofLevels(1, 1, 10, {1024}), std::invalid_argument);
  EXPECT_THROW(GrayImage::ofLevels(2, 1, 10, {1}), std::invalid_argument);
  EXPECT_THROW(GrayImage::ofLevels(1, 1, 11, {1}), std::invalid_argument);
}

TEST(Png, RefusesWhatIsNoPicture) {
  EXPECT_THROW(encodePng(GrayImage{}), std::invalid_argument);
  GrayImage torn(4, 4);
  torn.pixels.pop_back();
  EXPECT_THROW(encodePng(torn), std::invalid_argument);
  GrayImage shallow(4, 4);
  shallow.bits = 10;
  EXPECT_THROW(encodePng(shallow), std::invalid_argument);
  EXPECT_THROW(decodeImage({}), std::invalid_argument);
  const std::vector<std::uint8_t> noise{1, 2, 3, 4, 5};
  EXPECT_THROW(decodeImage(noise), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::camera
