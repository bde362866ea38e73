// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/source/gpio/fake_libgpiod.h"

#include <gpiod.h>

#include <cerrno>
#include <filesystem>

namespace kerfbench::source {
FakeLibgpiod fake_libgpiod;
}

using kerfbench::source::fake_libgpiod;

struct gpiod_chip {
  std::string name;
};
struct gpiod_chip_info {
  std::string name;
};
struct gpiod_line_info {
  unsigned offset;
};

namespace {

const kerfbench::source::FakeLine& of(gpiod_line_info* line) { return fake_libgpiod.lines.at(line->offset); }
const char* textOrNull(const std::string& text) { return text.empty() ? nullptr : text.c_str(); }

/// Counts an object that has to be freed as an open chip.
template <typename T>
T* given(T value) {
  ++fake_libgpiod.open_chips;
  return new T(std::move(value));
}
template <typename T>
void taken(T* value) {
  --fake_libgpiod.open_chips;
  delete value;
}

}  // namespace

extern "C" {

gpiod_chip* gpiod_chip_open(const char* path) {
  if (fake_libgpiod.open_error != 0) {
    errno = fake_libgpiod.open_error;
    return nullptr;
  }
  return given(gpiod_chip{std::filesystem::path(path).filename().string()});
}
void gpiod_chip_close(gpiod_chip* chip) { taken(chip); }

gpiod_chip_info* gpiod_chip_get_info(gpiod_chip* chip) {
  if (fake_libgpiod.info_error != 0) {
    errno = fake_libgpiod.info_error;
    return nullptr;
  }
  return given(gpiod_chip_info{chip->name});
}
void gpiod_chip_info_free(gpiod_chip_info* info) { taken(info); }
const char* gpiod_chip_info_get_name(gpiod_chip_info* info) { return info->name.c_str(); }
const char* gpiod_chip_info_get_label(gpiod_chip_info*) { return fake_libgpiod.label.c_str(); }
size_t gpiod_chip_info_get_num_lines(gpiod_chip_info*) { return fake_libgpiod.lines.size(); }

gpiod_line_info* gpiod_chip_get_line_info(gpiod_chip*, unsigned offset) {
  if (fake_libgpiod.line_error != 0 && offset + 1 == fake_libgpiod.lines.size()) {
    errno = fake_libgpiod.line_error;
    return nullptr;
  }
  return given(gpiod_line_info{offset});
}
void gpiod_line_info_free(gpiod_line_info* info) { taken(info); }
unsigned gpiod_line_info_get_offset(gpiod_line_info* info) { return info->offset; }
const char* gpiod_line_info_get_name(gpiod_line_info* info) { return textOrNull(of(info).name); }
const char* gpiod_line_info_get_consumer(gpiod_line_info* info) { return textOrNull(of(info).consumer); }
bool gpiod_line_info_is_used(gpiod_line_info* info) { return of(info).used; }
bool gpiod_line_info_is_active_low(gpiod_line_info* info) { return of(info).active_low; }
gpiod_line_direction gpiod_line_info_get_direction(gpiod_line_info* info) {
  return of(info).output ? GPIOD_LINE_DIRECTION_OUTPUT : GPIOD_LINE_DIRECTION_INPUT;
}

}  // extern "C"
