// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/virtual_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

#include "hil/base/file_content.h"

namespace kerfbench::doctor {
namespace {

namespace fs = std::filesystem;

std::string firstLine(const fs::path& path) {
  std::istringstream file(base::fileContent(path).value_or(""));
  std::string line;
  std::getline(file, line, '\n');
  if (const auto end = line.find('\0'); end != std::string::npos) line.resize(end);
  return line;
}

bool processorSaysSo(const fs::path& cpuinfo) {
  std::istringstream file(base::fileContent(cpuinfo).value_or(""));
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("flags")) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      if (word == "hypervisor") return true;
    }
  }
  return false;
}

}  // namespace

std::string virtualMachineSign(const fs::path& root) {
  // Makers of computers that are none (systemd-detect-virt knows them by the same names).
  constexpr std::array<std::string_view, 8> kMakers{"QEMU", "KVM",   "VMware",        "innotek GmbH",
                                                    "Xen",  "Bochs", "Apple Virtual", "Amazon EC2"};
  const std::string maker = firstLine(root / "sys/class/dmi/id/sys_vendor");
  if (std::ranges::any_of(kMakers, [&](std::string_view name) { return maker.starts_with(name); }))
    return fmt::format("its maker is '{}'", maker);
  if (const std::string type = firstLine(root / "sys/hypervisor/type"); !type.empty())
    return fmt::format("the kernel names the hypervisor '{}'", type);
  if (const std::string type = firstLine(root / "proc/device-tree/hypervisor/compatible"); !type.empty())
    return fmt::format("the device tree names the hypervisor '{}'", type);
  if (processorSaysSo(root / "proc/cpuinfo")) return "the processor has the flag 'hypervisor'";
  return "";
}

}  // namespace kerfbench::doctor
