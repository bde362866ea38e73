// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <string>

#include "hil/base/digest.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/kerf_tile.h"
#include "hil/camera/png.h"
#include "hil/camera/tile_folder.h"
#include "hil/camera/v4l2/frame_recording.h"
#include "hil/camera/v4l2/gray_decode.h"
#include "hil/camera/v4l2/pixel_format.h"
#include "tests/fuzz/targets.h"
#include "twin/base/image.h"

namespace kerfbench::fuzz {

bool picture(Bytes bytes) {
  return takes<std::invalid_argument>([&] { (void)camera::decodeImage(bytes); });
}

/// Parts: tiles.yaml, and the picture a.png beside it.
bool tileList(Bytes bytes) {
  return takes<base::ConfigError>([&] {
    (void)asFile("a.png", partOf(bytes, 1));
    camera::TileFolder folder(asFile("tiles.yaml", partOf(bytes, 0)).parent_path());
    while (!folder.nextBatch(2).empty()) {
    }
  });
}

/// The first six bytes say what a driver announces: format, width, height, bits, range.
bool cameraFrame(Bytes bytes) {
  constexpr std::size_t kHead = 6;
  if (bytes.size() < kHead) return false;
  const auto formats = camera::pixelFormats();
  camera::FrameLayout layout;
  layout.format = &formats[bytes[0] % formats.size()];
  layout.width_px = 2 * (1 + bytes[1] % 64);
  layout.height_px = 2 * (1 + bytes[2] % 64);
  layout.bits = 8 + bytes[3] % (layout.format->bits - 7);
  layout.full_range = bytes[4] % 2 == 1;
  layout.stride_bytes =
      static_cast<std::size_t>(layout.width_px) * static_cast<std::size_t>(layout.format->bytesPerPixel()) +
      bytes[5] % 16;
  return takes<std::invalid_argument>([&] { (void)camera::decodeFrame(layout, bytes.subspan(kHead)); });
}

/// Parts: camera.yaml but for its last line, which is the sum of the index; frames.csv; frames.raw.
bool frameRecording(Bytes bytes) {
  return takes<base::ConfigError>([&] {
    const std::string index(partOf(bytes, 1));
    (void)asFile("frames.csv", std::string_view(index));
    (void)asFile("frames.raw", partOf(bytes, 2));
    const std::string camera = std::string(partOf(bytes, 0)) + "index_sha256: " + base::sha256(index) + "\n";
    camera::FrameRecording frames(asFile("camera.yaml", std::string_view(camera)).parent_path());
    while (frames.next(0).kind == camera::StreamEvent::Kind::kFrame) {
    }
  });
}

}  // namespace kerfbench::fuzz
