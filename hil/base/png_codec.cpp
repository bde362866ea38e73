// SPDX-License-Identifier: Apache-2.0
#include "hil/base/png_codec.h"

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include <png.h>

namespace kerfbench::base {
namespace {

constexpr std::size_t kSignature = 8;
constexpr std::size_t kMostPixels = std::size_t{1} << 30U;
// A file of a megabyte may stand for a gigabyte of one colour. Up to so many pixels it may; more pixels need
// bytes.
constexpr std::size_t kFreePixels = std::size_t{1} << 26U;
constexpr std::size_t kMostPixelsOfByte = 64;

// libpng leaves a call that fails by longjmp. A function that calls setjmp has therefore no local object with
// a destructor, and changes no local variable that it reads after the jump: all of that is in the struct of
// its caller.

[[noreturn]] void onError(png_structp png, png_const_charp /*what*/) { png_longjmp(png, 1); }
void onWarning(png_structp /*png*/, png_const_charp /*what*/) {}

std::size_t rowBytes(int width_px, int channels, int bits) {
  return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(channels) *
         static_cast<std::size_t>(bits / 8);
}

struct Writer {
  explicit Writer(const PngView& view) : picture(view) {}
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  const PngView& picture;
  std::vector<std::uint8_t> bytes;
  png_structp png{png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, onError, onWarning)};
  png_infop info{png != nullptr ? png_create_info_struct(png) : nullptr};
};

void append(png_structp png, png_bytep data, std::size_t size) {
  auto& bytes = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  bytes.insert(bytes.end(), data, data + size);
}

bool writePng(Writer& writer, PngEffort effort) {
  if (writer.info == nullptr) return false;
  const PngView& picture = writer.picture;
  const png_structp png = writer.png;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_write_fn(png, &writer.bytes, append, nullptr);
  if (effort == PngEffort::kQuick) {
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_compression_level(png, 1);
    png_set_compression_strategy(png, 3);  // Z_RLE.
  } else {
    // Level 9 takes eight times as long, for pictures that are a twentieth smaller.
    png_set_compression_level(png, 6);
    png_set_compression_strategy(png, 0);  // Z_DEFAULT_STRATEGY.
  }
  png_set_IHDR(png, writer.info, static_cast<png_uint_32>(picture.width_px),
               static_cast<png_uint_32>(picture.height_px), picture.bits,
               picture.channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, writer.info);
  if (picture.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  const std::size_t stride = rowBytes(picture.width_px, picture.channels, picture.bits);
  for (int row = 0; row < picture.height_px; ++row)
    png_write_row(png, picture.bytes.data() + stride * static_cast<std::size_t>(row));
  png_write_end(png, writer.info);
  return true;
}

struct Reader {
  explicit Reader(std::span<const std::uint8_t> file) : left(file), bytes(file.size()) {}
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  std::span<const std::uint8_t> left;
  std::size_t bytes;
  PngSamples picture;
  std::vector<png_bytep> rows;
  png_structp png{png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, onError, onWarning)};
  png_infop info{png != nullptr ? png_create_info_struct(png) : nullptr};
};

void take(png_structp png, png_bytep to, std::size_t size) {
  auto& left = *static_cast<std::span<const std::uint8_t>*>(png_get_io_ptr(png));
  if (size > left.size()) png_error(png, "the file ends too early");
  std::copy_n(left.begin(), size, to);
  left = left.subspan(size);
}

void setTransformations(const Reader& reader, PngColours colours) {
  const png_structp png = reader.png;
  const int type = png_get_color_type(png, reader.info);
  const int depth = png_get_bit_depth(png, reader.info);
  const bool is_colour = (type & PNG_COLOR_MASK_COLOR) != 0;
  if (depth == 16 && colours == PngColours::kRgb) png_set_strip_16(png);
  if (depth == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  png_set_strip_alpha(png);
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (!is_colour && depth < 8) png_set_expand_gray_1_2_4_to_8(png);
  if (colours == PngColours::kRgb) {
    if (!is_colour) png_set_gray_to_rgb(png);
  } else {
    png_set_rgb_to_gray(png, PNG_ERROR_ACTION_NONE, 0.299, 0.587);
  }
  png_set_interlace_handling(png);
}

bool readPng(Reader& reader, PngColours colours) {
  if (reader.info == nullptr) return false;
  const png_structp png = reader.png;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_read_fn(png, &reader.left, take);
  png_read_info(png, reader.info);
  const std::size_t width = png_get_image_width(png, reader.info);
  const std::size_t height = png_get_image_height(png, reader.info);
  if (width * height >= kMostPixels) return false;
  if (width * height > std::max(kFreePixels, kMostPixelsOfByte * reader.bytes)) return false;
  setTransformations(reader, colours);
  png_read_update_info(png, reader.info);
  PngSamples& picture = reader.picture;
  picture.width_px = static_cast<int>(width);
  picture.height_px = static_cast<int>(height);
  picture.channels = colours == PngColours::kRgb ? 3 : 1;
  picture.bits = png_get_bit_depth(png, reader.info);
  const std::size_t stride = png_get_rowbytes(png, reader.info);
  if (stride != rowBytes(picture.width_px, picture.channels, picture.bits)) return false;
  picture.bytes.resize(stride * height);
  reader.rows.resize(height);
  for (std::size_t row = 0; row < height; ++row) reader.rows[row] = picture.bytes.data() + stride * row;
  png_read_image(png, reader.rows.data());
  png_read_end(png, reader.info);
  return true;
}

}  // namespace

std::vector<std::uint8_t> encodePng(const PngView& picture, PngEffort effort) {
  const bool sound = picture.width_px > 0 && picture.height_px > 0 &&
                     (picture.channels == 1 || picture.channels == 3) &&
                     (picture.bits == 8 || picture.bits == 16) &&
                     picture.bytes.size() == rowBytes(picture.width_px, picture.channels, picture.bits) *
                                                 static_cast<std::size_t>(picture.height_px);
  if (!sound) throw std::invalid_argument("encodePng: an image without pixels");
  Writer writer(picture);
  if (!writePng(writer, effort)) throw std::invalid_argument("encodePng: libpng refused the image");
  return std::move(writer.bytes);
}

std::optional<PngSamples> decodePng(std::span<const std::uint8_t> bytes, PngColours colours) {
  if (bytes.size() < kSignature || png_sig_cmp(bytes.data(), 0, kSignature) != 0) return std::nullopt;
  Reader reader(bytes);
  if (!readPng(reader, colours)) return std::nullopt;
  return std::move(reader.picture);
}

}  // namespace kerfbench::base
