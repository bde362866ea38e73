// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <string>

#include "hil/controller/uart_listener.h"
#include "hil/trace/trace_file.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {

/// The controller's words, in pieces as a serial line brings them. True where a report was understood.
bool serialWords(Bytes bytes) {
  controller::UartListener listener;
  constexpr std::size_t kPiece = 7;
  double now_s = 0.0;
  for (; !bytes.empty(); now_s += 1e-3) {
    const std::size_t size = std::min(kPiece, bytes.size());
    listener.hear(bytes.first(size), now_s);
    bytes = bytes.subspan(size);
  }
  return !listener.reports().empty();
}

bool traceRecover(Bytes bytes) {
  return takes<std::runtime_error>([&] {
    const auto file = asFile("run.mcap", bytes);
    (void)trace::traceInfo(file);
    (void)trace::rewriteTrace(file, file.parent_path() / "recovered.mcap");
  });
}

}  // namespace kerfbench::fuzz
