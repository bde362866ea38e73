// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "hil/source/cortex_m_child/device.h"

namespace kerfbench::cortex_m_child {

/// What the core reaches beside its memories.
class CoreBus {
 public:
  virtual ~CoreBus() = default;
  /// An access to devices, their bits or the system's registers, while Present::cycle is that of the access;
  /// nothing, or false, is a bus fault.
  virtual std::optional<std::uint32_t> readDevice(std::uint32_t address, unsigned bytes) = 0;
  virtual bool writeDevice(std::uint32_t address, unsigned bytes, std::uint32_t value) = 0;
  /// A store to the flash; it is the interface of the flash that programs it.
  virtual bool writeFlash(std::uint32_t offset, unsigned bytes, std::uint32_t value) = 0;
};

}  // namespace kerfbench::cortex_m_child
