// SPDX-License-Identifier: Apache-2.0
#include "hil/base/one_processor.h"

#include <unistd.h>

#include <cstddef>

namespace kerfbench::base {
namespace {

// Turns last some 0.1 ms, and one that is left to the scheduler twice as long.
constexpr unsigned kTurnsTogether = 128;

}  // namespace

OneProcessor::OneProcessor(pid_t other) : other_(other), thread_(::gettid()) {
  if (other_ <= 0) return;
  if (::sched_getaffinity(thread_, sizeof allowed_, &allowed_) != 0 ||
      ::sched_getaffinity(other_, sizeof allowed_other_, &allowed_other_) != 0)
    other_ = 0;
}

OneProcessor::~OneProcessor() {
  if (other_ > 0) release();
}

void OneProcessor::turn() {
  if (other_ <= 0) return;
  const unsigned turn = turns_++ % kTurnsTogether;
  if (turn == 0 && turns_ > 1) release();
  if (turn != 1) return;
  const int processor = ::sched_getcpu();
  if (processor < 0 || processor >= CPU_SETSIZE) return;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(processor), &one);
  (void)::sched_setaffinity(thread_, sizeof one, &one);
  (void)::sched_setaffinity(other_, sizeof one, &one);
}

void OneProcessor::release() {
  (void)::sched_setaffinity(thread_, sizeof allowed_, &allowed_);
  (void)::sched_setaffinity(other_, sizeof allowed_other_, &allowed_other_);
}

}  // namespace kerfbench::base
