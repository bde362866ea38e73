// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::source {

/// Text of the Error that `work` throws.
template <typename Error, typename Work>
std::string wordsOf(const Work& work) {
  try {
    work();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace kerfbench::source
