// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/tile_folder.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/png.h"

namespace kerfbench::hil {
namespace {

constexpr const char* kList = "tiles.yaml";

GrayImage readPicture(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  try {
    return decodeImage(bytes);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(path.string() + ": is no picture that can be read");
  }
}

}  // namespace

TileFolder::TileFolder(const std::filesystem::path& folder) {
  auto file = YamlReader::openFile(folder / kList);
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  auto tiles = file.list("tiles");
  if (tiles.empty()) file.fault("tiles", "there are none");
  for (YamlReader& tile : tiles) {
    const std::string name = tile.text("file");
    const auto place = tile.numbers("p_TV_mm", 2, {.min = -1e6, .max = 1e6});
    const auto unit = tile.integer("unit", {.min = 0, .max = 1e6, .fallback = 0.0});
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(folder / name, ignored))
      tile.fault("file", fmt::format("there is no {}", (folder / name).string()));
    entries_.push_back({folder / name, static_cast<int>(unit), {place[0], place[1]}});
  }
  file.finish();
}

std::vector<KerfTile> TileFolder::nextBatch(std::size_t max) {
  std::vector<KerfTile> tiles;
  const std::size_t end = next_ + std::min(max, entries_.size() - next_);
  for (; next_ < end; ++next_) {
    const Entry& entry = entries_[next_];
    tiles.push_back({readPicture(entry.file), entry.p_TV_mm, entry.unit});
  }
  return tiles;
}

void writeTiles(TileSource& source, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::string list = "version: 1\ntiles:\n";
  std::size_t number = 0;
  constexpr std::size_t kBatch = 4;
  for (auto tiles = source.nextBatch(kBatch); !tiles.empty(); tiles = source.nextBatch(kBatch)) {
    for (const KerfTile& tile : tiles) {
      const std::string name = fmt::format("tile-{:04}.png", number++);
      const std::vector<std::uint8_t> png = encodePng(tile.image);
      writeFileAtomically(folder / name, {reinterpret_cast<const char*>(png.data()), png.size()});
      list += fmt::format("  - {{file: {}, unit: {}, p_TV_mm: [{:.17g}, {:.17g}]}}\n", name, tile.unit,
                          tile.p_TV_mm.x(), tile.p_TV_mm.y());
    }
  }
  writeFileAtomically(folder / kList, list);
}

}  // namespace kerfbench::hil
