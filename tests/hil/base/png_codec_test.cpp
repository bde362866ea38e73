// SPDX-License-Identifier: Apache-2.0
#include "hil/base/png_codec.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

namespace kerfbench::base {
namespace {

constexpr int kWidth = 13, kHeight = 9;

/// A PNG as other programs write it.
struct Foreign {
  int type{PNG_COLOR_TYPE_GRAY};
  int depth{8};
  int interlace{PNG_INTERLACE_NONE};
};

/// PNG from rows of bytes, of which libpng's writer takes what type and depth say.
std::vector<std::uint8_t> foreignPng(const Foreign& kind, const std::vector<std::vector<std::uint8_t>>& rows,
                                     std::vector<png_color> palette = {}) {
  std::vector<std::uint8_t> bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp to, png_bytep data, std::size_t size) {
        auto& all = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(to));
        all.insert(all.end(), data, data + size);
      },
      nullptr);
  png_set_IHDR(png, info, kWidth, kHeight, kind.depth, kind.type, kind.interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  png_write_info(png, info);
  if (kind.depth < 8) png_set_packing(png);
  std::vector<png_bytep> pointers;
  std::vector<std::vector<std::uint8_t>> copy = rows;
  for (auto& row : copy) pointers.push_back(row.data());
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

/// Rows with the given number of bytes a pixel, by a function of column, row and channel.
template <typename Sample>
std::vector<std::vector<std::uint8_t>> rowsOf(int channels, const Sample& sample) {
  std::vector<std::vector<std::uint8_t>> rows(kHeight);
  for (int r = 0; r < kHeight; ++r) {
    for (int c = 0; c < kWidth; ++c) {
      for (int k = 0; k < channels; ++k)
        rows[static_cast<std::size_t>(r)].push_back(static_cast<std::uint8_t>(sample(c, r, k)));
    }
  }
  return rows;
}

std::vector<std::uint8_t> flat(const std::vector<std::vector<std::uint8_t>>& rows) {
  std::vector<std::uint8_t> all;
  for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
  return all;
}

const auto kColour = [](int c, int r, int k) { return (c * 17 + r * 29 + k * 71) % 256; };

TEST(PngCodec, GivesBackEverySampleOfEveryKindThatItWrites) {
  for (const PngEffort effort : {PngEffort::kQuick, PngEffort::kSmall}) {
    for (const int channels : {1, 3}) {
      const auto bytes = flat(rowsOf(channels, kColour));
      const auto png = encodePng({kWidth, kHeight, channels, 8, bytes}, effort);
      EXPECT_EQ(encodePng({kWidth, kHeight, channels, 8, bytes}, effort), png);
      const auto back = decodePng(png, channels == 1 ? PngColours::kGrey : PngColours::kRgb);
      ASSERT_TRUE(back);
      EXPECT_EQ(back->width_px, kWidth);
      EXPECT_EQ(back->height_px, kHeight);
      EXPECT_EQ(back->bytes, bytes);
    }
    const auto deep = flat(rowsOf(2, kColour));
    const auto back = decodePng(encodePng({kWidth, kHeight, 1, 16, deep}, effort), PngColours::kGrey);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->bits, 16);
    EXPECT_EQ(back->bytes, deep);
  }
}

TEST(PngCodec, MakesGreyOfColourAsRec601) {
  const auto rows = rowsOf(3, kColour);
  const auto grey = decodePng(foreignPng({PNG_COLOR_TYPE_RGB}, rows), PngColours::kGrey);
  ASSERT_TRUE(grey);
  for (int r = 0; r < kHeight; ++r) {
    for (int c = 0; c < kWidth; ++c) {
      EXPECT_NEAR(grey->bytes[static_cast<std::size_t>(r * kWidth + c)],
                  0.299 * kColour(c, r, 0) + 0.587 * kColour(c, r, 1) + 0.114 * kColour(c, r, 2), 1.0);
    }
  }
}

TEST(PngCodec, ReadsTheSamePictureFromEveryKindOfFile) {
  const auto rows = rowsOf(3, kColour);
  const auto expected = decodePng(foreignPng({PNG_COLOR_TYPE_RGB}, rows), PngColours::kGrey);
  ASSERT_TRUE(expected);
  const auto same = [&](const std::vector<std::uint8_t>& png, const char* what) {
    const auto grey = decodePng(png, PngColours::kGrey);
    ASSERT_TRUE(grey) << what;
    EXPECT_EQ(grey->bytes, expected->bytes) << what;
    const auto colour = decodePng(png, PngColours::kRgb);
    ASSERT_TRUE(colour) << what;
    EXPECT_EQ(colour->bytes, flat(rows)) << what;
  };
  same(foreignPng({PNG_COLOR_TYPE_RGB, 8, PNG_INTERLACE_ADAM7}, rows), "interlaced");
  same(foreignPng({PNG_COLOR_TYPE_RGB_ALPHA},
                  rowsOf(4, [](int c, int r, int k) { return k < 3 ? kColour(c, r, k) : 40; })),
       "with transparency");
  // The palette has all colours: there are fewer than 256 of them.
  std::vector<png_color> palette;
  const auto indices = rowsOf(1, [&](int c, int r, int) {
    palette.push_back({static_cast<png_byte>(kColour(c, r, 0)), static_cast<png_byte>(kColour(c, r, 1)),
                       static_cast<png_byte>(kColour(c, r, 2))});
    return palette.size() - 1;
  });
  same(foreignPng({PNG_COLOR_TYPE_PALETTE}, indices, palette), "with a palette");
}

TEST(PngCodec, SpreadsFewerBitsOverTheWholeRange) {
  for (const int depth : {1, 2, 4}) {
    const int top = (1 << depth) - 1;
    const auto grey = decodePng(
        foreignPng({PNG_COLOR_TYPE_GRAY, depth}, rowsOf(1, [&](int c, int, int) { return c % (top + 1); })),
        PngColours::kGrey);
    ASSERT_TRUE(grey);
    for (int c = 0; c < kWidth; ++c)
      EXPECT_EQ(grey->bytes[static_cast<std::size_t>(c)], c % (top + 1) * 255 / top) << depth;
  }
}

TEST(PngCodec, KeepsSixteenBitsOfGreyAndTheUpperEightOfColour) {
  // libpng's writer takes the upper byte first.
  const auto rows = rowsOf(2, [](int c, int, int k) { return k == 0 ? c : 0x80; });
  const auto png = foreignPng({PNG_COLOR_TYPE_GRAY, 16}, rows);
  const auto grey = decodePng(png, PngColours::kGrey);
  ASSERT_TRUE(grey);
  ASSERT_EQ(grey->bits, 16);
  EXPECT_EQ(grey->bytes[2 * 5] + 256 * grey->bytes[2 * 5 + 1], 0x580);
  const auto colour = decodePng(png, PngColours::kRgb);
  ASSERT_TRUE(colour);
  ASSERT_EQ(colour->bits, 8);
  EXPECT_EQ(colour->bytes[3 * 5 + 1], 5);
}

// A file that was cut off or changed on the disk must not pass for a picture.
TEST(PngCodec, RefusesEveryFileThatIsCutOffOrChanged) {
  const auto png = encodePng({kWidth, kHeight, 1, 8, flat(rowsOf(1, kColour))}, PngEffort::kQuick);
  for (std::size_t size = 0; size < png.size(); ++size)
    EXPECT_FALSE(decodePng(std::span(png).first(size), PngColours::kGrey)) << size;
  constexpr std::size_t kEndChunk = 12;
  for (std::size_t at = 0; at < png.size() - kEndChunk; ++at) {
    std::vector<std::uint8_t> changed = png;
    changed[at] ^= 0x10U;
    EXPECT_FALSE(decodePng(changed, PngColours::kGrey)) << at;
  }
}

// A few hundred kilobytes of one grey that stand for 67 million pixels and more: refused before they are
// unpacked.
TEST(PngCodec, RefusesMorePixelsThanTheBytesCanSay) {
  constexpr int kSide = 8193;
  const std::vector<std::uint8_t> grey(std::size_t{kSide} * kSide, 7);
  const auto encodedSquare = [&](int side) {
    const auto area = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    return encodePng({side, side, 1, 8, std::span(grey).first(area)}, PngEffort::kQuick);
  };
  const std::vector<std::uint8_t> bomb = encodedSquare(kSide);
  EXPECT_LT(bomb.size(), std::size_t{1} << 20U);
  EXPECT_FALSE(decodePng(bomb, PngColours::kGrey).has_value());
  EXPECT_TRUE(decodePng(encodedSquare(kSide - 1), PngColours::kGrey).has_value());
}

TEST(PngCodec, WritesNothingThatIsNoPicture) {
  const std::vector<std::uint8_t> four(4);
  EXPECT_THROW((void)encodePng({0, 4, 1, 8, {}}, PngEffort::kQuick), std::invalid_argument);
  EXPECT_THROW((void)encodePng({2, 3, 1, 8, four}, PngEffort::kQuick), std::invalid_argument);
  EXPECT_THROW((void)encodePng({2, 1, 2, 8, four}, PngEffort::kQuick), std::invalid_argument);
  EXPECT_THROW((void)encodePng({4, 1, 1, 12, four}, PngEffort::kQuick), std::invalid_argument);
  EXPECT_NO_THROW((void)encodePng({2, 2, 1, 8, four}, PngEffort::kQuick));
}

}  // namespace
}  // namespace kerfbench::base
