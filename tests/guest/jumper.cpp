// SPDX-License-Identifier: Apache-2.0
// A wire for gpio-sim, whose lines are not joined to each other: loaded into a program by LD_PRELOAD, it
// pulls a line of the simulated chip whenever the program drives its first output, within the same call, as a
// wire would. KERFBENCH_JUMPER: the `pull` file of the line that follows.
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/gpio.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdlib>
#include <string_view>

namespace {

using Control = int (*)(int, unsigned long, void*);

void follow(bool level) {
  static const int pull = [] {
    const char* const path = std::getenv("KERFBENCH_JUMPER");
    return path == nullptr ? -1 : ::open(path, O_WRONLY | O_CLOEXEC);
  }();
  const std::string_view text = level ? "pull-up" : "pull-down";
  if (::pwrite(pull, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) std::abort();
}

}  // namespace

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  static const auto control = reinterpret_cast<Control>(::dlsym(RTLD_NEXT, "ioctl"));
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  const int result = control(fd, request, argument);
  if (result >= 0 && request == GPIO_V2_LINE_SET_VALUES_IOCTL) {
    const auto* const values = static_cast<const gpio_v2_line_values*>(argument);
    if ((values->mask & 1U) != 0) follow((values->bits & 1U) != 0);
  }
  return result;
}
