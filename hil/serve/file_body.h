// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "hil/base/unique_fd.h"
#include "hil/serve/answer.h"

namespace kerfbench::serve {

/// A file, or the range of it that the request asks for with Range (RFC 9110). One range of bytes: a header
/// with several is answered with the whole file, as the RFC allows. 416 beyond its end.
/// @throws std::system_error if it cannot be read.
Answer fileAnswer(base::UniqueFd file, const std::string& name, const HttpHead& head);

/// A file that grows, from a byte on, until `is_finished` said so before its end was found.
class GrowingFileBody final : public AnswerBody {
 public:
  /// `file`: opens it; an invalid descriptor: it is not there yet.
  GrowingFileBody(std::function<base::UniqueFd()> file, std::uint64_t from,
                  std::function<bool()> is_finished);
  std::optional<std::string> next(const std::function<bool()>& is_gone) override;

 private:
  std::function<base::UniqueFd()> open_;
  base::UniqueFd file_;
  std::uint64_t at_;
  std::function<bool()> is_finished_;
};

/// Lines of a text file that grows.
class LineTail {
 public:
  explicit LineTail(std::string path) : path_(std::move(path)) {}
  /// Hands on the lines that were ended since the last call, without their ends; with `all` also one that has
  /// none. A line is cut at kLongestLine.
  void read(const std::function<void(const std::string& line)>& take, bool all = false);

  static constexpr std::size_t kLongestLine = 64 * 1024;

 private:
  std::string path_;
  base::UniqueFd file_;
  std::string begun_;
};

}  // namespace kerfbench::serve
