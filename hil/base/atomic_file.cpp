// SPDX-License-Identifier: Apache-2.0
#include "hil/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

namespace kerfbench::base {
namespace {

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& path) {
  throw std::system_error(errno, std::generic_category(), what + " " + path.string());
}

/// What a user who names a file can mend: the folder is not there, is none, or is not to be written in.
bool isTheFolder(int error) {
  return error == ENOENT || error == ENOTDIR || error == EACCES || error == EPERM || error == EROFS ||
         error == ELOOP || error == ENAMETOOLONG;
}

std::filesystem::path folderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

/// A file without a name, which is gone with its descriptor; invalid where the drive has no such files, or
/// nothing could give it a name later.
UniqueFd nameless(const std::filesystem::path& folder) {
  if (::access("/proc/self/fd", X_OK) != 0) return {};
  return UniqueFd(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
}

std::string hiddenBeside(const std::filesystem::path& path, const std::string& end) {
  return (folderOf(path) / ("." + path.filename().string() + "." + end)).string();
}

void syncFolder(const std::filesystem::path& folder) {
  const UniqueFd fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems refuse to sync a folder; the rename itself has already happened.
  if (fd.get() >= 0) (void)::fsync(fd.get());
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)), fd_(nameless(folderOf(path_))) {
  if (fd_.valid()) return;
  std::string name = hiddenBeside(path_, "XXXXXX");
  fd_ = UniqueFd(::mkostemp(name.data(), O_CLOEXEC));
  if (fd_.valid()) {
    temporary_.emplace(name);
    return;
  }
  const int error = errno;
  if (!isTheFolder(error)) fail("cannot create a file beside", path_);
  throw FolderError(
      error, std::generic_category(),
      path_.string() + " cannot be written: its folder " + folderOf(path_).string() + " cannot be used");
}

AtomicFile::~AtomicFile() = default;

void AtomicFile::write(std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(fd_.get(), content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot write", path_);
    content.remove_prefix(static_cast<std::size_t>(n));
  }
}

/// A nameless file cannot take the place of another one: it gets a name beside it first.
void AtomicFile::giveName() {
  const std::string own = "/proc/self/fd/" + std::to_string(fd_.get());
  const std::string process = std::to_string(::getpid()) + "-";
  for (unsigned n = 0;; ++n) {
    temporary_.emplace(hiddenBeside(path_, process + std::to_string(fd_.get()) + "-" + std::to_string(n)));
    if (::linkat(AT_FDCWD, own.c_str(), AT_FDCWD, temporary_->path().c_str(), AT_SYMLINK_FOLLOW) == 0) return;
    const int error = errno;
    temporary_->becomes({});  // The name is somebody else's.
    errno = error;
    if (error != EEXIST) fail("cannot name the file beside", path_);
  }
}

void AtomicFile::commit() {
  if (::fchmod(fd_.get(), 0644) != 0 || ::fsync(fd_.get()) != 0) fail("cannot sync", path_);
  if (!temporary_) giveName();
  if (::rename(temporary_->path().c_str(), path_.c_str()) != 0) fail("cannot rename to", path_);
  temporary_->becomes({});
  syncFolder(folderOf(path_));
}

void writeFileAtomically(const std::filesystem::path& path, std::string_view content) {
  AtomicFile file(path);
  file.write(content);
  file.commit();
}

}  // namespace kerfbench::base
