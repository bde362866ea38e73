// SPDX-License-Identifier: Apache-2.0
#include "hil/base/temporary.h"

#include <fcntl.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is no part of <cstdlib>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace kerfbench::base {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kLetters = "XXXXXX";

/// All that are to be removed. Never destroyed: a thread may lose one while the process ends.
struct Register {
  std::mutex mutex;
  std::vector<const TemporaryPath*> paths;
};
Register& all() {
  static auto* const made = new Register;
  return *made;
}

void removeAll(const fs::path& path) noexcept {
  // Somebody may still write there.
  constexpr int kTries = 10;
  for (int i = 0; i < kTries && !path.empty(); ++i) {
    std::error_code failed;
    fs::remove_all(path, failed);
    if (!failed) return;
  }
}

/// The folder, locked; invalid if it is not there, or another one has it.
UniqueFd locked(const fs::path& folder) {
  UniqueFd fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (!fd.valid() || ::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) return {};
  struct stat open {};
  struct stat named {};
  const bool same = ::fstat(fd.get(), &open) == 0 && ::lstat(folder.c_str(), &named) == 0 &&
                    open.st_ino == named.st_ino && open.st_uid == ::geteuid();
  return same ? std::move(fd) : UniqueFd();
}

void removeLeftBehind(const fs::path& parent, const std::string& prefix) {
  std::error_code failed;
  const std::string begin = prefix + ".";
  for (fs::directory_iterator at(parent, failed), end; !failed && at != end; at.increment(failed)) {
    const std::string name = at->path().filename().string();
    if (name.size() != begin.size() + kLetters.size() || !name.starts_with(begin)) continue;
    const auto is_letter = [](unsigned char c) { return std::isalnum(c) != 0; };
    if (!std::all_of(name.begin() + static_cast<std::ptrdiff_t>(begin.size()), name.end(), is_letter))
      continue;
    if (locked(at->path()).valid()) removeAll(at->path());
  }
}

fs::path made(const fs::path& parent, const std::string& prefix, UniqueFd& lock) {
  fs::create_directories(parent);
  removeLeftBehind(parent, prefix);
  for (;;) {
    std::string name = (parent / (prefix + "." + std::string(kLetters))).string();
    if (::mkdtemp(name.data()) == nullptr)
      throw std::system_error(errno, std::generic_category(), "cannot make a folder in " + parent.string());
    lock = locked(name);
    // Between the two another process may have taken it for one that was left behind. Drives that know no
    // locks have it that nobody takes it.
    if (lock.valid() || fs::exists(name)) return name;
  }
}

}  // namespace

TemporaryPath::TemporaryPath(fs::path path) : path_(std::move(path)) {
  const std::scoped_lock guard(all().mutex);
  all().paths.push_back(this);
}

TemporaryPath::~TemporaryPath() {
  removeAll(path_);  // Before the path is forgotten: the process may be ended in between.
  const std::scoped_lock guard(all().mutex);
  std::erase(all().paths, this);
}

void TemporaryPath::becomes(fs::path path) {
  const std::scoped_lock guard(all().mutex);
  path_.swap(path);
}

void removeTemporaries() noexcept {
  all().mutex.lock();
  for (const TemporaryPath* temporary : all().paths) removeAll(temporary->path());
}

TemporaryFolder::TemporaryFolder(const fs::path& parent, const std::string& prefix)
    : path_(made(fs::absolute(parent), prefix, lock_)) {}

}  // namespace kerfbench::base
