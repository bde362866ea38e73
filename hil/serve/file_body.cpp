// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/file_body.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <system_error>
#include <utility>

namespace kerfbench::serve {
namespace {

constexpr std::size_t kPiece = 256 * 1024;
/// Between two looks at a file that grows.
constexpr int kLookAgain_ms = 20;

/// Empty at the end of the file.
std::string pieceAt(int fd, std::uint64_t at, std::uint64_t most) {
  std::string piece(static_cast<std::size_t>(std::min<std::uint64_t>(most, kPiece)), '\0');
  ssize_t got = 0;
  do got = ::pread(fd, piece.data(), piece.size(), static_cast<off_t>(at));
  while (got < 0 && errno == EINTR);
  if (got < 0) throw std::system_error(errno, std::generic_category(), "cannot read");
  piece.resize(static_cast<std::size_t>(got));
  return piece;
}

class FileBody final : public AnswerBody {
 public:
  FileBody(base::UniqueFd file, std::uint64_t from, std::uint64_t bytes)
      : file_(std::move(file)), at_(from), left_(bytes) {}
  std::optional<std::string> next(const std::function<bool()>&) override {
    if (left_ == 0) return std::nullopt;
    std::string piece = pieceAt(file_.get(), at_, left_);
    if (piece.empty()) return std::nullopt;  // A file that became shorter meanwhile; the client sees that.
    at_ += piece.size();
    left_ -= piece.size();
    return piece;
  }

 private:
  base::UniqueFd file_;
  std::uint64_t at_, left_;
};

struct Range {
  std::uint64_t first{}, last{};
};

std::optional<std::uint64_t> numberIn(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// "bytes=0-499", "bytes=500-", "bytes=-500"; nullopt: it is none that is understood, so that the whole is
/// the answer. A range with first > last: there is nothing of it.
std::optional<Range> rangeIn(std::string_view text, std::uint64_t size) {
  constexpr std::string_view kUnit{"bytes="};
  if (!text.starts_with(kUnit)) return std::nullopt;
  text.remove_prefix(kUnit.size());
  const auto dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const std::optional<std::uint64_t> first = numberIn(text.substr(0, dash));
  const std::optional<std::uint64_t> last = numberIn(text.substr(dash + 1));
  const bool has_first = dash > 0, has_last = dash + 1 < text.size();
  if ((has_first && !first) || (has_last && !last) || (!has_first && !has_last)) return std::nullopt;
  if (!has_first)
    return *last == 0 || size == 0 ? Range{1, 0} : Range{size - std::min(*last, size), size - 1};
  if (has_last && *first > *last) return std::nullopt;
  if (*first >= size) return Range{1, 0};
  return Range{*first, has_last ? std::min(*last, size - 1) : size - 1};
}

}  // namespace

Answer fileAnswer(base::UniqueFd file, const std::string& name, const HttpHead& head) {
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) throw std::system_error(errno, std::generic_category(), name);
  const auto size = static_cast<std::uint64_t>(status.st_size);
  Answer answer;
  answer.type = typeOf(name);
  answer.headers.emplace_back("Accept-Ranges", "bytes");
  Range range{0, size == 0 ? 0 : size - 1};
  std::uint64_t bytes = size;
  const std::string* asked = head.header("range");
  if (const auto found = asked == nullptr ? std::nullopt : rangeIn(*asked, size)) {
    if (found->first > found->last) {
      answer = errorAnswer(416, "The file does not reach so far.");
      answer.headers.emplace_back("Content-Range", fmt::format("bytes */{}", size));
      return answer;
    }
    range = *found;
    bytes = range.last - range.first + 1;
    answer.status = 206;
    answer.headers.emplace_back("Content-Range",
                                fmt::format("bytes {}-{}/{}", range.first, range.last, size));
  }
  answer.body_bytes = bytes;
  answer.body = std::make_unique<FileBody>(std::move(file), range.first, bytes);
  return answer;
}

GrowingFileBody::GrowingFileBody(std::function<base::UniqueFd()> file, std::uint64_t from,
                                 std::function<bool()> is_finished)
    : open_(std::move(file)), at_(from), is_finished_(std::move(is_finished)) {}

std::optional<std::string> GrowingFileBody::next(const std::function<bool()>& is_gone) {
  while (!is_gone()) {
    // Asked first: what was written before that is found below.
    const bool is_finished = is_finished_();
    if (!file_.valid()) file_ = open_();
    if (file_.valid()) {
      std::string piece = pieceAt(file_.get(), at_, kPiece);
      at_ += piece.size();
      if (!piece.empty()) return piece;
    }
    if (is_finished) return std::nullopt;
    (void)::poll(nullptr, 0, kLookAgain_ms);
  }
  return std::nullopt;
}

void LineTail::read(const std::function<void(const std::string& line)>& take, bool all) {
  if (!file_.valid()) file_ = base::UniqueFd(::open(path_.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file_.valid()) return;
  std::string piece(kPiece, '\0');
  while (true) {
    const ssize_t got = ::read(file_.get(), piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    for (ssize_t i = 0; i < got; ++i) {
      const char c = piece[static_cast<std::size_t>(i)];
      if (c == '\n')
        take(std::exchange(begun_, {}));
      else if (begun_.size() < kLongestLine)
        begun_ += c;
    }
  }
  if (all && !begun_.empty()) take(std::exchange(begun_, {}));
}

}  // namespace kerfbench::serve
