// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/http_head.h"

#include "hil/serve/refusal.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {

bool httpHead(Bytes bytes) {
  return takes<serve::Refusal>([&] {
    const std::string_view text = textIn(bytes);
    if (const auto length = serve::headLength(text)) {
      (void)serve::parseHead(text.substr(0, *length));
    } else {
      throw serve::Refusal(400, "no whole head");
    }
  });
}

}  // namespace kerfbench::fuzz
