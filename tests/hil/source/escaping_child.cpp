// SPDX-License-Identifier: Apache-2.0
// A child whose emulator has been taken over by its firmware: it does what the controller's name says.
#include <arpa/inet.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "hil/source/emulator/run_child.h"

namespace {

using kerfbench::emulator::Clock;
using kerfbench::emulator::Emulator;
using kerfbench::emulator::OpenRequest;
using kerfbench::emulator::RunResult;

constexpr std::size_t kPage = 4096;

void* somePage() {
  return ::mmap(nullptr, kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
}

/// What it tries, and whether it came about.
const std::map<std::string, std::function<bool()>> kAttempts{
    {"opens a file", [] { return ::open("/etc/passwd", O_RDONLY) >= 0; }},
    {"opens a file anew", [] { return ::close(0) == 0 && ::open("/etc/passwd", O_RDONLY) >= 0; }},
    {"makes a file", [] { return ::open("/tmp/kerfbench-escaped", O_CREAT | O_WRONLY, 0600) >= 0; }},
    {"removes a file", [] { return ::unlink("/tmp/kerfbench-escaped-not-there") == 0; }},
    {"opens a socket", [] { return ::socket(AF_INET, SOCK_STREAM, 0) >= 0; }},
    {"forks", [] { return ::fork() >= 0; }},
    {"runs a program", [] { return ::execl("/bin/true", "true", nullptr) == 0; }},
    {"makes code",
     [] {
       return ::mmap(nullptr, kPage, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED;
     }},
    {"makes memory code", [] { return ::mprotect(somePage(), kPage, PROT_READ | PROT_EXEC) == 0; }},
    {"maps a file", [] { return ::mmap(nullptr, kPage, PROT_READ, MAP_PRIVATE, 0, 0) != MAP_FAILED; }},
    {"kills the bench", [] { return ::kill(::getppid(), SIGKILL) == 0; }},
    {"looks into the bench", [] { return ::ptrace(PTRACE_ATTACH, ::getppid(), nullptr, nullptr) == 0; }},
    {"reads the bench",
     [] {
       char byte{};
       const iovec here{&byte, 1}, there{&byte, 1};
       return ::process_vm_readv(::getppid(), &here, 1, &there, 1, 0) == 1;
     }},
};

void touch(std::size_t bytes) {
  std::string memory(bytes, 'x');
  volatile char* const last = &memory.back();  // What nobody looks at need not be taken.
  *last = 'y';
}

/// What an honest emulator does as well.
const std::map<std::string, std::function<void()>> kHonest{
    {"computes", [] {}},
    {"prints", [] { std::printf("a word\n"); }},
    {"takes memory", [] { touch(std::size_t{64} << 20U); }},
    {"throws",
     [] {
       try {
         throw std::runtime_error("and catches");
       } catch (const std::runtime_error&) {
         return;
       }
     }},
    {"aborts", [] { std::abort(); }},
    {"takes too much memory", [] { touch(std::size_t{8} << 30U); }},
};

class TakenOver final : public Emulator {
 public:
  explicit TakenOver(std::string what) : what_(std::move(what)) {}
  [[nodiscard]] Clock clock() const override { return {1, 1'000'000, 0}; }
  [[nodiscard]] std::string configuration() const override { return "taken over"; }
  void drive(std::uint64_t, std::uint16_t, std::uint16_t, bool) override {}
  void send(std::span<const std::uint8_t>) override {}
  RunResult run(std::uint64_t until) override {
    if (const auto honest = kHonest.find(what_); honest != kHonest.end()) {
      honest->second();
      return {KB_PS_REACHED, until, {}, {}, {}};
    }
    const bool escaped = kAttempts.at(what_)();
    return {KB_PS_CRASHED, until, {}, {}, escaped ? "escaped" : "was let go on"};
  }

 private:
  std::string what_;
};

}  // namespace

int main() {
  return kerfbench::emulator::runChild(
      "escaping_child", [](const OpenRequest& asked) { return std::make_unique<TakenOver>(asked.mcu); },
      [](const std::string&) { return std::string(); });
}
