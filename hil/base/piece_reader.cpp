// SPDX-License-Identifier: Apache-2.0
#include "hil/base/piece_reader.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include "hil/base/input_error.h"
#include "hil/base/input_file.h"

namespace kerfbench::base {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18U;

}  // namespace

PieceReader::PieceReader(const std::filesystem::path& path, std::string what) : what_(std::move(what)) {
  OpenedInput file = openInput(path, kAnySize);
  if (!file.fd.valid() && file.error != 0) fail(file.error);
  if (!file.fd.valid()) throw InputError(what_ + ": " + file.refusal);
  fd_ = std::move(file.fd);
  size_ = file.size_bytes;
  (void)::posix_fadvise(fd_.get(), 0, 0, POSIX_FADV_SEQUENTIAL);
}

std::size_t PieceReader::read(std::span<char> piece) {
  std::size_t got = 0;
  while (got < piece.size()) {
    const ssize_t n = ::read(fd_.get(), piece.data() + got, piece.size() - got);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(errno);
    if (n == 0) break;
    got += static_cast<std::size_t>(n);
  }
  return got;
}

void PieceReader::seek(std::uint64_t at) {
  if (::lseek(fd_.get(), static_cast<off_t>(at), SEEK_SET) < 0) fail(errno);
}

void PieceReader::fail(int error) const { throw std::system_error(error, std::generic_category(), what_); }

void forEachPiece(PieceReader& file, std::uint64_t most, const std::function<void(std::string_view)>& take) {
  std::vector<char> piece(kPiece);
  while (most > 0) {
    const std::size_t wanted = static_cast<std::size_t>(std::min<std::uint64_t>(most, kPiece));
    const std::size_t got = file.read(std::span(piece).first(wanted));
    take({piece.data(), got});
    if (got < wanted) return;
    most -= got;
  }
}

}  // namespace kerfbench::base
