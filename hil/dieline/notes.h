// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace kerfbench::dieline {

/// Counts what a reader leaves out or mends, by name, so that nothing is left out in silence.
class NoteList {
 public:
  /// Counts one more of `what` ("TEXT", "LINE on the frozen layer 'OLD'"); `done` says what became of it
  /// ("ignored: it is not cut").
  void add(int line, std::string_view what, std::string_view done);
  /// One sentence for each, with the number and the first line: "TEXT: 3 ignored: it is not cut, the first at
  /// line 12".
  [[nodiscard]] std::vector<std::string> sentences() const;

 private:
  struct Counted {
    std::size_t count{};
    int first_line{};
  };
  std::map<std::pair<std::string, std::string>, Counted, std::less<>> counted_;
};

}  // namespace kerfbench::dieline
