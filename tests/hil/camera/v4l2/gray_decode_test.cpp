// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/gray_decode.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>  // The header jpeglib.h uses FILE and does not include it.
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jpeglib.h>

#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

using testing::HasSubstr;

FrameLayout layoutOf(std::string_view name, int width, int height, std::size_t padding = 0) {
  FrameLayout layout;
  layout.format = findPixelFormat(name);
  EXPECT_NE(layout.format, nullptr) << name;
  layout.width_px = width;
  layout.height_px = height;
  layout.stride_bytes = static_cast<std::size_t>(width * layout.format->bytesPerPixel()) + padding;
  layout.bits = layout.format->bits;
  return layout;
}

/// Rows of 16-bit words; the padding is filled with values that must not be read.
std::vector<std::uint8_t> bytesOfWords(const FrameLayout& layout, const std::vector<int>& words) {
  std::vector<std::uint8_t> bytes(layout.stride_bytes * static_cast<std::size_t>(layout.height_px), 0xee);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto width = static_cast<std::size_t>(layout.width_px);
    const std::size_t at = i / width * layout.stride_bytes + 2 * (i % width);
    bytes[at] = static_cast<std::uint8_t>(words[i] & 0xff);
    bytes[at + 1] = static_cast<std::uint8_t>(words[i] >> 8);
  }
  return bytes;
}

std::string whyNot(const FrameLayout& layout, const std::vector<std::uint8_t>& bytes) {
  try {
    (void)decodeFrame(layout, bytes);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "it is a frame";
}

TEST(PixelFormats, HaveNamesAndCodesOfTheirOwnAndAreFoundByBoth) {
  std::set<std::uint32_t> codes;
  for (const PixelFormat& format : pixelFormats()) {
    EXPECT_TRUE(codes.insert(format.fourcc).second) << format.name;
    EXPECT_EQ(findPixelFormat(format.fourcc), &format);
    EXPECT_EQ(findPixelFormat(format.name), &format);
  }
  EXPECT_EQ(codes.size(), 22U);
  EXPECT_EQ(findPixelFormat("NV12"), nullptr);
  EXPECT_EQ(findPixelFormat(0x3231564eU), nullptr);
  EXPECT_EQ(fourccText(findPixelFormat("Y10")->fourcc), "Y10");
  EXPECT_EQ(fourccText(0x01020304U), "????");
}

TEST(PixelFormats, OfGreyCostNothingAndAllOthersSomething) {
  const std::set<std::string_view> free{"GREY", "Y10", "Y12", "Y16"};
  for (const PixelFormat& format : pixelFormats())
    EXPECT_EQ(format.cost.empty(), free.contains(format.name)) << format.name;
}

TEST(GrayDecode, TakesGreyRowByRowAndLeavesThePadding) {
  const FrameLayout layout = layoutOf("GREY", 3, 2, 5);
  std::vector<std::uint8_t> bytes(16, 0xee);
  for (std::size_t i = 0; i < 3; ++i) {
    bytes[i] = static_cast<std::uint8_t>(10 + i);
    bytes[8 + i] = static_cast<std::uint8_t>(20 + i);
  }
  bytes.resize(11);  // The last row's padding need not be there.
  const GrayImage image = decodeFrame(layout, bytes);
  EXPECT_EQ(image.pixels, (std::vector<std::uint8_t>{10, 11, 12, 20, 21, 22}));
  bytes.pop_back();
  EXPECT_THAT(whyNot(layout, bytes), HasSubstr("10 bytes where a frame has 11"));
}

class DeepGrey : public testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(DeepGrey, KeepsEveryLevel) {
  const auto [name, bits] = GetParam();
  const int top = (1 << bits) - 1;
  const FrameLayout layout = layoutOf(name, 2, 2, 6);
  const GrayImage image = decodeFrame(layout, bytesOfWords(layout, {0, 1, top / 3, top}));
  EXPECT_EQ(image.bits, bits);
  EXPECT_EQ(image.levels, (std::vector<std::uint16_t>{0, 1, static_cast<std::uint16_t>(top / 3),
                                                      static_cast<std::uint16_t>(top)}));
  EXPECT_THAT(whyNot(layout, bytesOfWords(layout, {0, 0, 0, top + 1})), HasSubstr("a level beyond"));
}

INSTANTIATE_TEST_SUITE_P(GrayDecode, DeepGrey, testing::Values(std::pair("Y10", 10), std::pair("Y12", 12)));

TEST(GrayDecode, MakesTwelveBitsOfSixteen) {
  const FrameLayout layout = layoutOf("Y16", 2, 1);
  const GrayImage image = decodeFrame(layout, bytesOfWords(layout, {0xffff, 0x1230}));
  EXPECT_EQ(image.bits, 12);
  EXPECT_EQ(image.levels, (std::vector<std::uint16_t>{0xfff, 0x123}));
}

TEST(GrayDecode, TakesASensorOfFewerBitsInSixteenAtItsOwnScale) {
  FrameLayout layout = layoutOf("Y16", 2, 1);
  for (const auto& [bits, depth] : {std::pair(8, 8), {9, 10}, {10, 10}, {11, 12}, {12, 12}, {14, 12}}) {
    layout.bits = bits;
    const int half = 1 << (bits - 1);
    const GrayImage image = decodeFrame(layout, bytesOfWords(layout, {0, half}));
    EXPECT_EQ(image.bits, depth);
    EXPECT_EQ(image.gray(1, 0), 128.0) << bits;
  }
}

TEST(GrayDecode, StretchesTheNarrowRangeOfBrightnessAndNoOther) {
  FrameLayout layout = layoutOf("YUYV", 4, 1);
  const std::vector<std::uint8_t> bytes{16, 90, 235, 200, 5, 1, 255, 2};
  EXPECT_EQ(decodeFrame(layout, bytes).pixels, (std::vector<std::uint8_t>{0, 255, 0, 255}));
  layout.full_range = true;
  EXPECT_EQ(decodeFrame(layout, bytes).pixels, (std::vector<std::uint8_t>{16, 235, 5, 255}));
}

// Colour filters: a scene of one colour shows which pixels are taken for which.
class BayerGrey : public testing::TestWithParam<std::string> {};

GrayImage bayerScene(const std::string& format, int red, int green, int blue) {
  const FrameLayout layout = layoutOf(format, 12, 10);
  const std::string order = format.substr(1, 4);
  std::vector<int> words;
  for (int r = 0; r < 10; ++r) {
    for (int c = 0; c < 12; ++c) {
      const char colour = order.at(static_cast<std::size_t>(r % 2 * 2 + c % 2));
      words.push_back(colour == 'R' ? red : colour == 'G' ? green : blue);
    }
  }
  if (layout.format->bytesPerPixel() == 2) return decodeFrame(layout, bytesOfWords(layout, words));
  return decodeFrame(layout, std::vector<std::uint8_t>(words.begin(), words.end()));
}

TEST_P(BayerGrey, WeighsTheColoursAsRec601) {
  const int bits = findPixelFormat(GetParam())->bits;
  const int level = 200 << (bits - 8);
  const auto middle = [&](int red, int green, int blue) {
    return bayerScene(GetParam(), red * level, green * level, blue * level).gray(6, 5);
  };
  EXPECT_NEAR(middle(1, 0, 0), 0.299 * 200, 1.0);
  EXPECT_NEAR(middle(0, 1, 0), 0.587 * 200, 1.0);
  EXPECT_NEAR(middle(0, 0, 1), 0.114 * 200, 1.0);
  EXPECT_NEAR(middle(1, 1, 1), 200, 1.0);
}

INSTANTIATE_TEST_SUITE_P(GrayDecode, BayerGrey,
                         testing::Values("SBGGR8", "SGBRG8", "SGRBG8", "SRGGB8", "SBGGR10", "SGBRG10",
                                         "SGRBG10", "SRGGB10", "SBGGR12", "SGBRG12", "SGRBG12", "SRGGB12",
                                         "SBGGR16", "SGBRG16", "SGRBG16", "SRGGB16"));

std::vector<std::uint8_t> jpegOf(int width, int height, bool coloured = false) {
  jpeg_error_mgr errors{};
  jpeg_compress_struct info{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &data, &size);
  info.image_width = static_cast<JDIMENSION>(width);
  info.image_height = static_cast<JDIMENSION>(height);
  info.input_components = coloured ? 3 : 1;
  info.in_color_space = coloured ? JCS_RGB : JCS_GRAYSCALE;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 100, TRUE);
  jpeg_start_compress(&info, TRUE);
  for (int r = 0; r < height; ++r) {
    std::vector<std::uint8_t> row;
    for (int c = 0; c < width; ++c)
      row.insert(row.end(), coloured ? 3 : 1, static_cast<std::uint8_t>(40 + 2 * c + r));
    JSAMPROW at = row.data();
    jpeg_write_scanlines(&info, &at, 1);
  }
  jpeg_finish_compress(&info);
  std::vector<std::uint8_t> bytes(data, data + size);
  jpeg_destroy_compress(&info);
  std::free(data);
  return bytes;
}

TEST(GrayDecode, ReadsAJpegAndItsPadding) {
  const FrameLayout layout = layoutOf("MJPEG", 48, 32);
  std::vector<std::uint8_t> bytes = jpegOf(48, 32);
  bytes.insert(bytes.end(), 100, 0);
  const GrayImage image = decodeFrame(layout, bytes);
  ASSERT_EQ(image.width, 48);
  for (int c = 0; c < 48; ++c) EXPECT_NEAR(image.at(c, 20), 60 + 2 * c, 3);
}

/// JPEG without the segments that define Huffman tables, as many cameras send it.
std::vector<std::uint8_t> withoutHuffmanTables(const std::vector<std::uint8_t>& jpeg) {
  std::vector<std::uint8_t> kept(jpeg.begin(), jpeg.begin() + 2);
  std::size_t at = 2;
  while (jpeg[at + 1] != 0xda) {  // The picture itself begins here.
    const std::size_t size = 2 + (std::size_t{jpeg[at + 2]} << 8U | jpeg[at + 3]);
    if (jpeg[at + 1] != 0xc4)
      kept.insert(kept.end(), jpeg.begin() + static_cast<long>(at),
                  jpeg.begin() + static_cast<long>(at + size));
    at += size;
  }
  kept.insert(kept.end(), jpeg.begin() + static_cast<long>(at), jpeg.end());
  return kept;
}

TEST(GrayDecode, ReadsAMotionJpegWithoutHuffmanTablesAndTheBrightnessOfAColouredOne) {
  const FrameLayout layout = layoutOf("MJPEG", 48, 32);
  const std::vector<std::uint8_t> grey = jpegOf(48, 32);
  const std::vector<std::uint8_t> bare = withoutHuffmanTables(grey);
  ASSERT_LT(bare.size(), grey.size());
  EXPECT_EQ(decodeFrame(layout, bare).pixels, decodeFrame(layout, grey).pixels);
  const GrayImage image = decodeFrame(layout, jpegOf(48, 32, true));
  for (int c = 0; c < 48; ++c) EXPECT_NEAR(image.at(c, 20), 60 + 2 * c, 3);
}

TEST(GrayDecode, RefusesAJpegThatIsCutOffBrokenOrOfAnotherSize) {
  const FrameLayout layout = layoutOf("MJPEG", 48, 32);
  std::vector<std::uint8_t> bytes = jpegOf(48, 32);
  std::vector<std::uint8_t> cut_off(bytes.begin(), bytes.begin() + static_cast<long>(bytes.size() / 2));
  EXPECT_THAT(whyNot(layout, cut_off), HasSubstr("cut off"));
  EXPECT_THAT(whyNot(layout, jpegOf(40, 32)), HasSubstr("40 x 32 and not 48 x 32"));
  EXPECT_THAT(whyNot(layout, {0xff, 0xd8, 0x12, 0x34, 0xff, 0xd9}), HasSubstr("cannot be read"));
  EXPECT_THAT(whyNot(layout, std::vector<std::uint8_t>(500, 0)), HasSubstr("no JPEG"));
  EXPECT_THAT(whyNot(layout, {}), HasSubstr("0 bytes"));
}

}  // namespace
}  // namespace kerfbench::camera
