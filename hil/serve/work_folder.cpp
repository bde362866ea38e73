// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/work_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "hil/base/atomic_file.h"
#include "hil/base/input_error.h"
#include "hil/base/installation.h"
#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 512;
constexpr std::size_t kMostParts = 12;
/// What a window has to do with. Nothing of it is run by its name: an image runs in an emulator, or has to be
/// executable, which no file that is written here is.
constexpr std::array kWritten{".dxf", ".svg", ".pdf", ".cf2", ".yaml", ".gcode", ".nc",  ".hex",
                              ".elf", ".bin", ".png", ".jpg", ".jpeg", ".csv",   ".vcd", ".sr"};

std::vector<std::string_view> partsOf(std::string_view name) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto slash = name.find('/');
    parts.push_back(name.substr(0, slash));
    if (slash == std::string_view::npos) return parts;
    name.remove_prefix(slash + 1);
  }
}

/// As RFC 3629 has it: no overlong forms, no surrogates.
bool isUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
    const unsigned lead = byte(i);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xc2 ? 0
                               : lead < 0xe0 ? 2
                               : lead < 0xf0 ? 3
                               : lead < 0xf5 ? 4
                                             : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k)
      if ((byte(i + k) & 0xc0U) != 0x80U) return false;
    const unsigned second = length > 1 ? byte(i + 1) : 0;
    if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second > 0x9f) ||
        (lead == 0xf0 && second < 0x90) || (lead == 0xf4 && second > 0x8f))
      return false;
    i += length;
  }
  return true;
}

/// The header of glibc 2.36 has no function for it.
int openBeneath(int folder, const std::string& path, std::uint64_t flags) {
  open_how how{};
  how.flags = flags | O_CLOEXEC;
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
  int fd = -1;
  // EAGAIN: somebody renamed a folder meanwhile.
  for (int tries = 0; tries < 16 && fd < 0; ++tries) {
    fd = static_cast<int>(::syscall(SYS_openat2, folder, path.c_str(), &how, sizeof how));
    if (fd < 0 && errno != EAGAIN && errno != EINTR) break;
  }
  return fd;
}

base::UniqueFd folderFd(const fs::path& folder) {
  base::UniqueFd fd(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!fd.valid()) throw base::InputError(fmt::format("{}: {}", folder.string(), std::strerror(errno)));
  return fd;
}

[[noreturn]] void refuseFor(int error, const std::string& name) {
  if (error == EXDEV || error == ELOOP || error == EACCES || error == EPERM)
    throw Refusal(403,
                  fmt::format("'{}' cannot be used: it is outside of the folder, or not readable.", name));
  if (error == ENAMETOOLONG) throw Refusal(400, "The name of the file is too long.");
  throw Refusal(404, fmt::format("There is no file '{}'.", name));
}

/// The folder of a file that shall be written, made where it is not there.
base::UniqueFd folderToWrite(int root, const std::string& name) {
  base::UniqueFd folder(openBeneath(root, ".", O_PATH | O_DIRECTORY));
  const std::vector<std::string_view> parts = partsOf(name);
  for (std::size_t i = 0; i + 1 < parts.size() && folder.valid(); ++i) {
    const std::string part(parts[i]);
    if (::mkdirat(folder.get(), part.c_str(), 0755) != 0 && errno != EEXIST)
      throw std::system_error(errno, std::generic_category(), "cannot make the folder of " + name);
    folder = base::UniqueFd(openBeneath(folder.get(), part, O_PATH | O_DIRECTORY | O_NOFOLLOW));
  }
  if (!folder.valid())
    throw Refusal(403, fmt::format("'{}' cannot be written: a part of its name is no folder in here.", name));
  return folder;
}

}  // namespace

ShippedFolders shippedFolders(const fs::path& bin_dir) {
  const fs::path data = base::shippedData(bin_dir);
  if (fs::is_directory(data / "scenarios"))
    return {fs::canonical(data), (bin_dir / ".." / "firmware").lexically_normal()};
  throw base::InputError(fmt::format("no machines and examples beside the programs in {}", bin_dir.string()));
}

WorkFolder::WorkFolder(fs::path folder, ShippedFolders shipped)
    : folder_(std::move(folder)),
      shipped_(std::move(shipped)),
      folder_fd_(folderFd(folder_)),
      fixtures_fd_(folderFd(shipped_.fixtures)) {
  // A bench may be built without releases.
  firmware_fd_ = base::UniqueFd(::open(shipped_.firmware.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
}

WorkFolder::Place WorkFolder::placeIn(const std::string& name) const {
  if (!isReadableName(name)) throw Refusal(400, "This is no name of a file in the folder.");
  if (!name.starts_with(kShipped)) return {folder_fd_.get(), folder_, name};
  std::string rest = name.substr(kShipped.size());
  constexpr std::string_view kFirmware{"firmware/"};
  if (rest.starts_with(kFirmware))
    return {firmware_fd_.get(), shipped_.firmware, rest.substr(kFirmware.size())};
  return {fixtures_fd_.get(), shipped_.fixtures, std::move(rest)};
}

base::UniqueFd WorkFolder::open(const std::string& name) const {
  const Place place = placeIn(name);
  // A named pipe, of which nobody writes the other end, must not keep a thread.
  base::UniqueFd fd(openBeneath(place.root, place.rest, O_RDONLY | O_NONBLOCK));
  if (!fd.valid()) refuseFor(errno, name);
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0 || !S_ISREG(status.st_mode)) refuseFor(ENOENT, name);
  return fd;
}

fs::path WorkFolder::pathOf(const std::string& name) const {
  (void)open(name);
  const Place place = placeIn(name);
  return place.root_path / place.rest;
}

fs::path WorkFolder::placeOf(const std::string& name) const {
  if (name.starts_with(kShipped)) return pathOf(name);
  const Place place = placeIn(name);
  base::UniqueFd fd(openBeneath(place.root, place.rest, O_PATH));
  if (!fd.valid() && errno != ENOENT) refuseFor(errno, name);
  return place.root_path / place.rest;
}

std::string WorkFolder::nameOf(const fs::path& path) const {
  const auto below = [&path](const fs::path& root, const std::string& before) -> std::string {
    const fs::path relative = path.lexically_normal().lexically_relative(root);
    if (relative.empty() || *relative.begin() == "..") return {};
    return before + relative.generic_string();
  };
  if (std::string name = below(folder_, ""); !name.empty()) return name;
  if (std::string name = below(shipped_.fixtures, std::string(kShipped)); !name.empty()) return name;
  return below(shipped_.firmware, std::string(kShipped) + "firmware/");
}

void WorkFolder::refuseUnwritable(const std::string& name) {
  if (name.starts_with(kShipped))
    throw Refusal(403, "What comes with the bench is not written. Save a copy.");
  if (!isWritableName(name))
    throw Refusal(
        400,
        "A file's name has letters from A to Z, digits, blanks, '.', '_' and '-', does not begin with "
        "'.' or '-', and is not among the results.");
  std::string ending = fs::path(name).extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (std::ranges::find(kWritten, ending) == kWritten.end())
    throw Refusal(415, fmt::format("Files ending in '{}' are not written here.", ending));
}

void WorkFolder::write(
    const std::string& name,
    const std::function<void(const std::function<void(std::string_view)>& take)>& content) const {
  refuseUnwritable(name);
  const base::UniqueFd folder = folderToWrite(folder_fd_.get(), name);
  base::AtomicFile file(fmt::format("/proc/self/fd/{}/{}", folder.get(), partsOf(name).back()));
  content([&file](std::string_view bytes) { file.write(bytes); });
  file.commit();
}

bool isReadableName(std::string_view name) {
  if (name.empty() || name.size() > kLongestName || !isUtf8(name)) return false;
  const auto parts = partsOf(name);
  return parts.size() <= kMostParts && std::ranges::all_of(parts, [](std::string_view part) {
           return !part.empty() && !part.starts_with('.') && std::ranges::all_of(part, [](char c) {
             return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f && c != '\\';
           });
         });
}

bool isWritableName(std::string_view name) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == ' ' ||
           c == '.' || c == '_' || c == '-' || c == '/';
  };
  if (!isReadableName(name) || !std::ranges::all_of(name, is_plain)) return false;
  const auto parts = partsOf(name);
  return parts.front() != "results" &&
         std::ranges::none_of(parts, [](std::string_view part) { return part.starts_with('-'); });
}

}  // namespace kerfbench::serve
