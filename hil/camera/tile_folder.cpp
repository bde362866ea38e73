// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/tile_folder.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/yaml_reader.h"
#include "hil/camera/kerf_tile.h"
#include "hil/camera/picture_file.h"
#include "hil/camera/png.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

constexpr const char* kList = "tiles.yaml";

/// Pictures are looked for in the folder of their list alone.
bool isBareName(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
}

}  // namespace

TileFolder::TileFolder(const std::filesystem::path& folder, std::optional<PictureSize> size)
    : folder_(folder), size_(size) {
  auto file = base::YamlReader::openFile(folder / kList);
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  auto tiles = file.list("tiles");
  if (tiles.empty()) file.fault("tiles", "there are none");
  std::set<std::string> names;
  for (base::YamlReader& tile : tiles) {
    const std::string name = tile.text("file");
    const auto place = tile.numbers("p_TV_mm", 2, {.min = -1e6, .max = 1e6});
    const auto unit = tile.integer("unit", {.min = 0, .max = 1e6, .fallback = 0.0});
    std::error_code ignored;
    if (!isBareName(name))
      tile.fault("file", fmt::format("{} is no name of a file beside this one", name));
    else if (!std::filesystem::is_regular_file(folder / name, ignored))
      tile.fault("file", fmt::format("there is no {}", (folder / name).string()));
    if (!names.insert(name).second) tile.fault("file", fmt::format("{} is listed twice", name));
    entries_.push_back({name, static_cast<int>(unit), {place[0], place[1]}});
  }
  file.finish();
}

std::vector<KerfTile> TileFolder::nextBatch(std::size_t max) {
  std::vector<KerfTile> tiles;
  const std::size_t end = next_ + std::min(max, entries_.size() - next_);
  for (; next_ < end; ++next_) {
    try {
      tiles.push_back(read(entries_[next_]));
    } catch (const base::ConfigError&) {
      throw base::ConfigError(faultsFrom(next_));
    }
  }
  return tiles;
}

KerfTile TileFolder::read(const Entry& entry) const {
  const std::filesystem::path file = folder_ / entry.name;
  GrayImage image = readPicture(file);
  if (size_ && (image.width != size_->width_px || image.height != size_->height_px)) {
    throw base::ConfigError(fmt::format("{}: has {} x {} pixels, the camera is calibrated for {} x {}",
                                        file.string(), image.width, image.height, size_->width_px,
                                        size_->height_px));
  }
  return {std::move(image), entry.p_TV_mm, entry.unit};
}

std::string TileFolder::sha256OfSums() const {
  std::string sums = fmt::format("{}  {}\n", base::sha256File(folder_ / kList), kList);
  for (const Entry& entry : entries_)
    sums += fmt::format("{}  {}\n", base::sha256File(folder_ / entry.name), entry.name);
  return base::sha256(sums);
}

std::string TileFolder::faultsFrom(std::size_t first) const {
  std::string faults;
  for (std::size_t at = first; at < entries_.size(); ++at) {
    try {
      static_cast<void>(read(entries_[at]));
    } catch (const base::ConfigError& error) {
      faults += fmt::format("{}{}", faults.empty() ? "" : "\n", error.what());
    }
  }
  return faults;
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
      base::writeFileAtomically(folder / name, {reinterpret_cast<const char*>(png.data()), png.size()});
      list += fmt::format("  - {{file: {}, unit: {}, p_TV_mm: [{:.17g}, {:.17g}]}}\n", name, tile.unit,
                          tile.p_TV_mm.x(), tile.p_TV_mm.y());
    }
  }
  base::writeFileAtomically(folder / kList, list);
}

}  // namespace kerfbench::camera
