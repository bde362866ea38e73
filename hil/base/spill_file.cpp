// SPDX-License-Identifier: Apache-2.0
#include "hil/base/spill_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

namespace kerfbench::base {
namespace {

// One call to the file system for many blocks. A file may get so much that it never uses.
constexpr std::size_t kLeastAllocated = std::size_t{16} << 20U;
constexpr std::size_t kMostAllocated = std::size_t{256} << 20U;

UniqueFd openNameless(const std::filesystem::path& folder) {
  UniqueFd fd(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (fd.valid() || (errno != EOPNOTSUPP && errno != EISDIR && errno != ENOENT)) return fd;
  // A file system without such files, as NFS.
  std::string name = (folder / "kerfbench.XXXXXX").string();
  fd = UniqueFd(::mkostemp(name.data(), O_CLOEXEC));
  if (fd.valid()) ::unlink(name.c_str());
  return fd;
}

}  // namespace

std::filesystem::path spillFolder() {
  const char* const wanted = std::getenv("TMPDIR");
  if (wanted != nullptr && *wanted != '\0') return wanted;
  constexpr const char* kLarge = "/var/tmp";
  return ::access(kLarge, W_OK | X_OK) == 0 ? kLarge : "/tmp";
}

SpillFile::SpillFile(std::filesystem::path folder) : folder_(std::move(folder)), fd_(openNameless(folder_)) {
  if (!fd_.valid())
    throw std::system_error(errno, std::generic_category(),
                            "no temporary file in " + folder_.string() + " (TMPDIR names another folder)");
}

void SpillFile::write(std::size_t at, std::span<const std::byte> bytes) {
  const std::size_t end = at + bytes.size();
  allocate(end);
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(fd_.get(), bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail(n < 0 ? errno : ENOSPC, end);
    at += static_cast<std::size_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

void SpillFile::allocate(std::size_t size) {
  if (size <= allocated_) return;
  const std::size_t ample = std::clamp(allocated_, kLeastAllocated, kMostAllocated);
  for (const std::size_t wanted : {std::max(size, allocated_ + ample), size}) {
    int failed = 0;
    do {
      failed = ::fallocate(fd_.get(), FALLOC_FL_KEEP_SIZE, static_cast<off_t>(allocated_),
                           static_cast<off_t>(wanted - allocated_)) == 0
                   ? 0
                   : errno;
    } while (failed == EINTR);
    if (failed == 0 || failed == EOPNOTSUPP) {
      allocated_ = wanted;
      return;
    }
    if (wanted == size) fail(failed, size);
  }
}

void SpillFile::fail(int error, std::size_t size) const {
  throw std::system_error(error, std::generic_category(),
                          fmt::format("no temporary file of {} bytes in {} (TMPDIR names another folder)",
                                      size, folder_.string()));
}

}  // namespace kerfbench::base
