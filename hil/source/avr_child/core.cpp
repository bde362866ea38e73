// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/core.h"

#include <sim_core.h>

#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

namespace kerfbench::avr_child {
namespace {

constexpr std::size_t kDataSpace = 0x10000 + 2;          // A pointer has two bytes.
constexpr std::size_t kFlashSpace = 0x1000000 + 0x1000;  // RAMPZ and Z have three, and SPM writes a page.

/// Memory that is not used costs nothing.
void enlarge(std::uint8_t*& memory, std::size_t size, std::size_t space) {
  auto* const larger = static_cast<std::uint8_t*>(std::calloc(space, 1));
  if (larger == nullptr) throw std::bad_alloc();
  std::memcpy(larger, memory, size);
  std::free(std::exchange(memory, larger));
}

}  // namespace

void boundMemories(avr_t& avr) {
  enlarge(avr.data, avr.ramend + std::size_t{1}, kDataSpace);
  enlarge(avr.flash, avr.flashend + std::size_t{1}, kFlashSpace);
}

void Core::run(Cycle limit) {
  avr_t* const avr = p_.avr;
  p_.limit = limit;
  p_.takeFlags();
  avr->run_cycle_count = 1;
  p_.watch();
  if (avr->pc >= p_.flash_bytes || avr->pc % 2 != 0) {  // The firmware has left its flash.
    avr->pc = avr_run_one(avr);
    return;
  }
  Operation* const at = &p_.code[avr->pc / 2];
  at->execute(p_, at, avr->cycle, avr->data);
}

}  // namespace kerfbench::avr_child
