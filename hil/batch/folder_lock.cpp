// SPDX-License-Identifier: Apache-2.0
#include "hil/batch/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/text.h"

namespace kerfbench::batch {
namespace {

constexpr const char* kLockFile = ".lock";

std::string nameOfThisProcess() {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  return fmt::format("process {} on {}\n", ::getpid(), host.data());
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder)
    : folder_(std::filesystem::absolute(folder).lexically_normal()),
      fd_(::open((folder_ / kLockFile).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  const std::string file = (folder_ / kLockFile).string();
  if (!fd_.valid()) throw std::system_error(errno, std::generic_category(), "cannot open " + file);
  if (::flock(fd_.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) throw std::system_error(errno, std::generic_category(), "cannot lock " + file);
    const std::string holder = base::fileContent(file).value_or("");
    throw base::InputError(
        fmt::format("{}: is being written by {}: wait for it, or stop it", folder_.string(),
                    holder.empty() ? "another process" : base::printable(base::trimmed(holder), 300)));
  }
  // For people alone: on a full disk the lock holds all the same.
  const std::string text = nameOfThisProcess();
  if (::ftruncate(fd_.get(), 0) == 0) (void)!::pwrite(fd_.get(), text.data(), text.size(), 0);
}

}  // namespace kerfbench::batch
