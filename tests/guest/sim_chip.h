// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kerfbench::guest {

/// A chip of the kernel's gpio-sim: lines that a test pulls as a controller would drive them.
class SimChip {
 public:
  /// Makes lines 0 … with these names ("": none). `label` names the chip and its folder in configfs.
  /// @throws std::system_error with the path; gpio-sim must be loaded and configfs mounted, by root.
  SimChip(std::string label, std::vector<std::string> line_names);
  ~SimChip();
  SimChip(const SimChip&) = delete;
  SimChip& operator=(const SimChip&) = delete;

  /// Device, e.g. "/dev/gpiochip1".
  [[nodiscard]] const std::filesystem::path& device() const { return device_; }
  /// Folder with the levels of the lines.
  [[nodiscard]] const std::filesystem::path& sysfs() const { return sysfs_; }
  [[nodiscard]] const std::string& label() const { return label_; }
  [[nodiscard]] const std::vector<std::string>& lineNames() const { return line_names_; }

  /// File of the kernel that pull() writes.
  [[nodiscard]] std::filesystem::path pullFile(std::uint32_t line) const;
  /// Sets the level that comes in on a line. @throws std::system_error when the chip has vanished.
  void pull(std::uint32_t line, bool high);
  /// Level of a line that is driven as an output.
  [[nodiscard]] bool value(std::uint32_t line) const;
  /// Takes the chip away, even if it is in use.
  void vanish();

 private:
  void make();
  void remove() noexcept;

  std::string label_;
  std::vector<std::string> line_names_;
  std::filesystem::path config_;
  std::filesystem::path device_;
  std::filesystem::path sysfs_;
  std::vector<int> pulls_;  ///< File descriptors.
};

}  // namespace kerfbench::guest
