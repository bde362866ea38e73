// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/system.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>

namespace kerfbench::source {
namespace {

KernelAnswer answer(long result) {
  return result < 0 ? KernelAnswer{-1, errno} : KernelAnswer{static_cast<int>(result), 0};
}

std::uint64_t read_ns(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(now.tv_nsec);
}

class LinuxGpioSystem final : public GpioSystem {
 public:
  KernelAnswer open(const std::string& path) override {
    return answer(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  }
  KernelAnswer control(int fd, unsigned long request, void* argument) override {
    return answer(::ioctl(fd, request, argument));
  }
  KernelAnswer read(int fd, std::span<std::byte> into) override {
    return answer(::read(fd, into.data(), into.size()));
  }
  KernelAnswer poll(int fd, std::uint64_t timeout_ns, short& revents) override {
    pollfd polled{fd, POLLIN, 0};
    const timespec timeout{static_cast<time_t>(timeout_ns / 1'000'000'000U),
                           static_cast<long>(timeout_ns % 1'000'000'000U)};
    const KernelAnswer ready = answer(::ppoll(&polled, 1, &timeout, nullptr));
    revents = polled.revents;
    return ready;
  }
  void close(int fd) override { ::close(fd); }
  std::uint64_t now_ns() override { return read_ns(CLOCK_MONOTONIC); }
  std::uint64_t threadTime_ns() override { return read_ns(CLOCK_THREAD_CPUTIME_ID); }
  KernelAnswer setRealTime(int priority) override {
    sched_param parameters{};
    parameters.sched_priority = priority;
    return answer(::sched_setscheduler(0, SCHED_FIFO, &parameters));
  }
  KernelAnswer lockMemory() override { return answer(::mlockall(MCL_CURRENT)); }
  void leaveRealTime() override {
    const sched_param none{};
    ::sched_setscheduler(0, SCHED_OTHER, &none);
    ::munlockall();
  }
};

}  // namespace

std::shared_ptr<GpioSystem> linuxGpioSystem() { return std::make_shared<LinuxGpioSystem>(); }

}  // namespace kerfbench::source
