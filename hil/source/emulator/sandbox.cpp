// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/sandbox.h"

#include <linux/capability.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

namespace kerfbench::emulator {
namespace {

/// What the C library asks for on behalf of code that computes, allocates, prints, throws and aborts.
constexpr std::array kAllowed{
    SCMP_SYS(read),          SCMP_SYS(write),  SCMP_SYS(writev),     SCMP_SYS(brk),
    SCMP_SYS(munmap),        SCMP_SYS(mremap), SCMP_SYS(madvise),    SCMP_SYS(futex),
    SCMP_SYS(clock_gettime), SCMP_SYS(getpid), SCMP_SYS(gettid),     SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(rt_sigreturn),  SCMP_SYS(exit),   SCMP_SYS(exit_group), SCMP_SYS(restart_syscall)};

[[noreturn]] void refuse(const char* what, int error) {
  throw std::runtime_error(std::string("the firmware is not run, because it cannot be confined: ") + what +
                           ": " + std::strerror(error));
}

void closeAllBut(int in_fd, int out_fd) {
  const auto [first, second] = std::minmax(in_fd, out_fd);
  const auto close = [](int from, int to) {
    if (from <= to && ::syscall(SYS_close_range, from, to, 0) != 0) refuse("close_range", errno);
  };
  close(STDERR_FILENO + 1, first - 1);
  close(first + 1, second - 1);
  close(second + 1, ~0U >> 1U);
}

void dropCapabilities() {
  for (unsigned long capability = 0; ::prctl(PR_CAPBSET_DROP, capability, 0, 0, 0) == 0; ++capability) {
  }
  __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> none{};
  if (::syscall(SYS_capset, &head, none.data()) != 0) refuse("capset", errno);
}

/// The filter that the kernel holds every further system call against.
class Filter {
 public:
  Filter() : context_(::seccomp_init(SCMP_ACT_KILL_PROCESS)) {
    if (context_ == nullptr) refuse("seccomp_init", ENOMEM);
  }
  ~Filter() { ::seccomp_release(context_); }
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;

  template <typename... Conditions>
  void allow(int call, Conditions... conditions) {
    const std::array<scmp_arg_cmp, sizeof...(Conditions)> all{conditions...};
    if (const int error =
            ::seccomp_rule_add_array(context_, SCMP_ACT_ALLOW, call, sizeof...(Conditions), all.data());
        error != 0)
      refuse("seccomp_rule_add", -error);
  }
  void load() {
    if (const int error = ::seccomp_load(context_); error != 0) refuse("seccomp_load", -error);
  }

 private:
  scmp_filter_ctx context_;
};

/// The argument's bits of `mask` are those of `wanted`.
scmp_arg_cmp bits(unsigned argument, scmp_datum_t mask, scmp_datum_t wanted) {
  return {argument, SCMP_CMP_MASKED_EQ, mask, wanted};
}

scmp_arg_cmp equal(unsigned argument, scmp_datum_t wanted) { return {argument, SCMP_CMP_EQ, wanted, 0}; }

}  // namespace

void enterSandbox(int in_fd, int out_fd) {
  // A buffered stream asks at its first use what it writes to.
  (void)std::setvbuf(stdout, nullptr, _IONBF, 0);
  (void)std::setvbuf(stderr, nullptr, _IONBF, 0);
  closeAllBut(in_fd, out_fd);
  dropCapabilities();
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) refuse("no_new_privs", errno);
  Filter filter;
  for (const int call : kAllowed) filter.allow(call);
  filter.allow(SCMP_SYS(mmap), bits(2, PROT_EXEC, 0), bits(3, MAP_ANONYMOUS, MAP_ANONYMOUS));
  filter.allow(SCMP_SYS(mprotect), bits(2, PROT_EXEC, 0));
  // For abort(), which sends a signal to its own process.
  filter.allow(SCMP_SYS(tgkill), equal(0, static_cast<scmp_datum_t>(::getpid())));
  filter.load();
}

}  // namespace kerfbench::emulator
