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

void syncFolder(const std::filesystem::path& folder) {
  const UniqueFd fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems refuse to sync a folder; the rename itself has already happened.
  if (fd.get() >= 0) (void)::fsync(fd.get());
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path)
    : path_(std::move(path)),
      temporary_((folderOf(path_) / ("." + path_.filename().string() + ".XXXXXX")).string()),
      fd_(::mkostemp(temporary_.data(), O_CLOEXEC)) {
  if (fd_.get() >= 0) return;
  const int error = errno;
  if (!isTheFolder(error)) fail("cannot create a file beside", path_);
  throw FolderError(
      error, std::generic_category(),
      path_.string() + " cannot be written: its folder " + folderOf(path_).string() + " cannot be used");
}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(fd_.get(), content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot write", path_);
    content.remove_prefix(static_cast<std::size_t>(n));
  }
}

void AtomicFile::commit() {
  if (::fchmod(fd_.get(), 0644) != 0 || ::fsync(fd_.get()) != 0) fail("cannot sync", path_);
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot rename to", path_);
  temporary_.clear();
  syncFolder(folderOf(path_));
}

void writeFileAtomically(const std::filesystem::path& path, std::string_view content) {
  AtomicFile file(path);
  file.write(content);
  file.commit();
}

}  // namespace kerfbench::base
