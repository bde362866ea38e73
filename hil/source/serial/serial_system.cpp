// SPDX-License-Identifier: Apache-2.0
#include "hil/source/serial/serial_system.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>

namespace kerfbench::source {
namespace {

SerialAnswer answer(long result) { return result < 0 ? SerialAnswer{-1, errno} : SerialAnswer{result, 0}; }

class LinuxSerialSystem final : public SerialSystem {
 public:
  SerialAnswer open(const std::string& path) override {
    return answer(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  }
  SerialAnswer control(int fd, unsigned long request, void* argument) override {
    return answer(::ioctl(fd, request, argument));
  }
  SerialAnswer read(int fd, std::span<std::byte> into) override {
    return answer(::read(fd, into.data(), into.size()));
  }
  SerialAnswer write(int fd, std::span<const std::byte> bytes) override {
    return answer(::write(fd, bytes.data(), bytes.size()));
  }
  void close(int fd) override { ::close(fd); }
};

}  // namespace

std::shared_ptr<SerialSystem> linuxSerialSystem() { return std::make_shared<LinuxSerialSystem>(); }

}  // namespace kerfbench::source
