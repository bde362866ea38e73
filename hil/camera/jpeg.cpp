// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/jpeg.h"

#include <algorithm>
#include <csetjmp>
#include <cstddef>
#include <cstdio>  // jpeglib.h uses FILE and does not include it.
#include <utility>

#include <jpeglib.h>

#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

constexpr std::size_t kMostPixels = std::size_t{1} << 30U;
// As of a PNG (png_codec.cpp): more pixels than these need bytes.
constexpr std::size_t kFreePixels = std::size_t{1} << 26U;
constexpr std::size_t kMostPixelsOfByte = 64;

/// libjpeg's own handler ends the program; this one returns to readJpeg().
struct ErrorExit {
  jpeg_error_mgr manager{};
  std::jmp_buf jump{};
};

[[noreturn]] void onError(j_common_ptr any) { std::longjmp(reinterpret_cast<ErrorExit*>(any->err)->jump, 1); }
void onMessage(j_common_ptr /*any*/) {}

struct Decoder {
  Decoder() {
    info.err = jpeg_std_error(&error.manager);
    error.manager.error_exit = onError;
    error.manager.output_message = onMessage;
  }
  ~Decoder() { jpeg_destroy_decompress(&info); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  ErrorExit error;
  jpeg_decompress_struct info{};
  GrayImage image;
};

// Left by longjmp: no local object here has a destructor.
bool readJpeg(Decoder& decoder, std::span<const std::uint8_t> bytes) {
  jpeg_decompress_struct& info = decoder.info;
  if (setjmp(decoder.error.jump) != 0) return false;
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, bytes.data(), bytes.size());
  jpeg_read_header(&info, TRUE);
  const std::size_t pixels = std::size_t{info.image_width} * info.image_height;
  if (pixels >= kMostPixels || pixels > std::max(kFreePixels, kMostPixelsOfByte * bytes.size())) return false;
  info.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&info);
  if (info.output_components != 1) return false;
  decoder.image = GrayImage(static_cast<int>(info.output_width), static_cast<int>(info.output_height));
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = decoder.image.row(static_cast<int>(info.output_scanline)).data();
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return true;
}

}  // namespace

std::optional<GrayImage> decodeJpeg(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 3 || bytes[0] != 0xff || bytes[1] != 0xd8 || bytes[2] != 0xff) return std::nullopt;
  Decoder decoder;
  if (!readJpeg(decoder, bytes)) return std::nullopt;
  return std::move(decoder.image);
}

}  // namespace kerfbench::camera
