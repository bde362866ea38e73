// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/core.h"

#include <sim_core.h>

namespace kerfbench::avr_child {

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
