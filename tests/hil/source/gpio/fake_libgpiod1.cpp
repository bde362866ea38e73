// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/source/gpio/fake_libgpiod.h"

#include <gpiod.h>

#include <cerrno>
#include <filesystem>
#include <vector>

namespace kerfbench::source {
FakeLibgpiod fake_libgpiod;
}

using kerfbench::source::fake_libgpiod;

struct gpiod_line {
  unsigned offset;
};
struct gpiod_chip {
  std::string name;
  std::vector<gpiod_line> lines;
};

namespace {

const kerfbench::source::FakeLine& of(gpiod_line* line) { return fake_libgpiod.lines.at(line->offset); }
const char* textOrNull(const std::string& text) { return text.empty() ? nullptr : text.c_str(); }

}  // namespace

extern "C" {

gpiod_chip* gpiod_chip_open(const char* path) {
  if (fake_libgpiod.open_error != 0) {
    errno = fake_libgpiod.open_error;
    return nullptr;
  }
  if (fake_libgpiod.info_error != 0) {
    errno = fake_libgpiod.info_error;
    return nullptr;
  }
  auto* chip = new gpiod_chip{std::filesystem::path(path).filename().string(), {}};
  for (unsigned i = 0; i < fake_libgpiod.lines.size(); ++i) chip->lines.push_back({i});
  ++fake_libgpiod.open_chips;
  return chip;
}
void gpiod_chip_close(gpiod_chip* chip) {
  --fake_libgpiod.open_chips;
  delete chip;
}
const char* gpiod_chip_name(gpiod_chip* chip) { return chip->name.c_str(); }
const char* gpiod_chip_label(gpiod_chip*) { return fake_libgpiod.label.c_str(); }
unsigned gpiod_chip_num_lines(gpiod_chip* chip) { return static_cast<unsigned>(chip->lines.size()); }
gpiod_line* gpiod_chip_get_line(gpiod_chip* chip, unsigned offset) {
  if (fake_libgpiod.line_error != 0 && offset + 1 == chip->lines.size()) {
    errno = fake_libgpiod.line_error;
    return nullptr;
  }
  return &chip->lines.at(offset);
}
unsigned gpiod_line_offset(gpiod_line* line) { return line->offset; }
const char* gpiod_line_name(gpiod_line* line) { return textOrNull(of(line).name); }
const char* gpiod_line_consumer(gpiod_line* line) { return textOrNull(of(line).consumer); }
bool gpiod_line_is_used(gpiod_line* line) { return of(line).used; }
int gpiod_line_direction(gpiod_line* line) {
  return of(line).output ? GPIOD_LINE_DIRECTION_OUTPUT : GPIOD_LINE_DIRECTION_INPUT;
}
int gpiod_line_active_state(gpiod_line* line) {
  return of(line).active_low ? GPIOD_LINE_ACTIVE_STATE_LOW : GPIOD_LINE_ACTIVE_STATE_HIGH;
}

}  // extern "C"
