// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/film.h"

#include <fstream>
#include <stdexcept>

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;

std::size_t pixelsOf(const Film& film) {
  return static_cast<std::size_t>(film.width_px) * static_cast<std::size_t>(film.height_px);
}

}  // namespace

std::span<const std::uint8_t> Film::picture(std::size_t index) const {
  return std::span(pixels).subspan(index * pixelsOf(*this), pixelsOf(*this));
}

void writeFilm(const fs::path& folder, const Film& film) {
  fs::create_directories(folder);
  std::ofstream text(folder / "film.txt");
  text << film.width_px << ' ' << film.height_px << '\n';
  for (const std::uint64_t at_ns : film.at_ns) text << at_ns << '\n';
  std::ofstream raw(folder / "film.raw", std::ios::binary);
  raw.write(reinterpret_cast<const char*>(film.pixels.data()),
            static_cast<std::streamsize>(film.pixels.size()));
  if (!text.flush() || !raw.flush()) throw std::runtime_error("cannot write " + folder.string());
}

Film readFilm(const fs::path& folder) {
  Film film;
  std::ifstream text(folder / "film.txt");
  text >> film.width_px >> film.height_px;
  for (std::uint64_t at_ns = 0; text >> at_ns;) film.at_ns.push_back(at_ns);
  film.pixels.resize(film.at_ns.size() * pixelsOf(film));
  std::ifstream raw(folder / "film.raw", std::ios::binary);
  raw.read(reinterpret_cast<char*>(film.pixels.data()), static_cast<std::streamsize>(film.pixels.size()));
  if (film.pixels.empty() || !raw) throw std::runtime_error("no film in " + folder.string());
  return film;
}

}  // namespace kerfbench::guest
