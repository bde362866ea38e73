// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/filmed_pins.h"

#include "tests/scenarios/filmed_cut.h"
#include "twin/base/image.h"

namespace kerfbench::guest {

Film filmOf(const std::filesystem::path& scenario, const std::filesystem::path& pins) {
  const test::FilmedCut cut(scenario, pins);
  Film film;
  for (const Frame& frame : cut.frames()) {
    film.width_px = frame.image.width;
    film.height_px = frame.image.height;
    film.at_ns.push_back(static_cast<std::uint64_t>(1e9 * frame.start_s));
    film.pixels.insert(film.pixels.end(), frame.image.pixels.begin(), frame.image.pixels.end());
  }
  return film;
}

}  // namespace kerfbench::guest
