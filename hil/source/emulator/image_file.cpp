// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/image_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace kerfbench::emulator {
namespace {

// Closes a file when it goes. Nothing of the bench is linked here, so that hil/base has another one.
struct Descriptor {
  int fd;
  ~Descriptor() {
    if (fd >= 0) (void)::close(fd);
  }
};

}  // namespace

std::string imageContent(const std::string& path) {
  constexpr std::size_t kMaxFileBytes = 16U << 20U;
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)};
  struct stat status {};
  if (file.fd < 0 || ::fstat(file.fd, &status) != 0)
    throw std::runtime_error(path + ": " + std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw std::runtime_error(path + ": is no regular file");
  std::string bytes;
  char block[65536];
  // The size that the file has is looked at before it is read, and what is read as well.
  for (std::size_t known = static_cast<std::size_t>(status.st_size);; known = bytes.size()) {
    if (known > kMaxFileBytes)
      throw std::runtime_error(path + ": has " + std::to_string(known) + " bytes, and at most " +
                               std::to_string(kMaxFileBytes) + " are read");
    const ssize_t got = ::read(file.fd, block, sizeof block);
    if (got == 0) return bytes;
    if (got < 0 && errno != EINTR) throw std::runtime_error(path + ": " + std::strerror(errno));
    if (got > 0) bytes.append(block, static_cast<std::size_t>(got));
  }
}

void refuseImage(const std::string& path, const std::string& where, const std::string& what) {
  throw std::runtime_error(path + where + ": " + what);
}

}  // namespace kerfbench::emulator
