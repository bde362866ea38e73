// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/sim_chip.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path) {
  throw std::system_error(errno, std::generic_category(), path.string());
}

int openForWriting(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) refuse(path);
  return fd;
}

void write(const fs::path& path, std::string_view text) {
  const int fd = openForWriting(path);
  const bool whole = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int error = errno;
  ::close(fd);
  errno = error;
  if (!whole) refuse(path);
}

std::string read(const fs::path& path) {
  std::ifstream file(path);
  std::string word;
  if (!(file >> word)) throw std::system_error(EIO, std::generic_category(), path.string());
  return word;
}

}  // namespace

SimChip::SimChip(std::string label, std::vector<std::string> line_names)
    : label_(std::move(label)),
      line_names_(std::move(line_names)),
      config_("/sys/kernel/config/gpio-sim/" + label_) {
  try {
    make();
  } catch (...) {
    remove();
    throw;
  }
}

SimChip::~SimChip() { remove(); }

void SimChip::make() {
  const fs::path bank = config_ / "bank0";
  fs::create_directories(bank);
  write(bank / "num_lines", std::to_string(line_names_.size()));
  write(bank / "label", label_);
  for (std::size_t i = 0; i < line_names_.size(); ++i) {
    if (line_names_[i].empty()) continue;
    const fs::path line = bank / ("line" + std::to_string(i));
    fs::create_directory(line);
    write(line / "name", line_names_[i]);
  }
  write(config_ / "live", "1");
  const std::string chip = read(bank / "chip_name");
  device_ = fs::path("/dev") / chip;
  sysfs_ = fs::path("/sys/devices/platform") / read(config_ / "dev_name") / chip;
  for (std::size_t i = 0; i < line_names_.size(); ++i)
    pulls_.push_back(openForWriting(pullFile(static_cast<std::uint32_t>(i))));
}

fs::path SimChip::pullFile(std::uint32_t line) const {
  return sysfs_ / ("sim_gpio" + std::to_string(line)) / "pull";
}

void SimChip::remove() noexcept {
  for (const int fd : pulls_) ::close(fd);
  std::error_code none;
  try {
    vanish();
  } catch (const std::system_error&) {  // The chip has gone already, or was never made.
  }
  const fs::path bank = config_ / "bank0";
  for (std::size_t i = 0; i < line_names_.size(); ++i) fs::remove(bank / ("line" + std::to_string(i)), none);
  fs::remove(bank, none);
  fs::remove(config_, none);
}

void SimChip::pull(std::uint32_t line, bool high) {
  const std::string_view text = high ? "pull-up" : "pull-down";
  if (::pwrite(pulls_.at(line), text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
    refuse(device_);
}

bool SimChip::value(std::uint32_t line) const {
  return read(sysfs_ / ("sim_gpio" + std::to_string(line)) / "value") == "1";
}

void SimChip::vanish() { write(config_ / "live", "0"); }

}  // namespace kerfbench::guest
