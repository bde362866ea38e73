// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/notes.h"

#include <fmt/format.h>

namespace kerfbench::dieline {

void NoteList::add(int line, std::string_view what, std::string_view done) {
  Counted& counted = counted_[{std::string(what), std::string(done)}];
  if (counted.count++ == 0) counted.first_line = line;
}

std::vector<std::string> NoteList::sentences() const {
  std::vector<std::string> sentences;
  for (const auto& [what, counted] : counted_) {
    sentences.push_back(fmt::format("{}: {} {} (the first at line {})", what.first, counted.count,
                                    what.second, counted.first_line));
  }
  return sentences;
}

}  // namespace kerfbench::dieline
