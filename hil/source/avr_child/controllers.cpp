// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/controllers.h"

#include <avr_ioport.h>
#include <avr_timer.h>
#include <avr_uart.h>
#include <fcntl.h>
#include <sim_avr.h>
#include <sim_io.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <string_view>
#include <system_error>
#include <vector>

// simavr's list of its controllers, ended by a null. Its header for it declares each of them as well.
extern "C" avr_kind_t* avr_kind[];

namespace kerfbench::avr_child {
namespace {

void sayNothing(avr_t* /*avr*/, int /*level*/, const char* /*format*/, va_list /*arguments*/) {}

/// Names of the modules of a kind: letters of ports, digits of timers and UARTs.
template <typename Module>
std::string namesOf(const avr_t& avr, std::string_view kind) {
  std::string names;
  for (avr_io_t* io = avr.io_port; io != nullptr; io = io->next) {
    if (kind == io->kind) names += reinterpret_cast<Module*>(io)->name;
  }
  std::ranges::sort(names);
  return names;
}

std::string describe(const avr_kind_t& kind) {
  std::string line;
  for (const char* name : kind.names) {
    if (name != nullptr) line += (line.empty() ? "" : " ") + std::string(name);
  }
  avr_t* const avr = avr_make_mcu_by_name(kind.names[0]);
  if (avr == nullptr) return {};
  avr_init(avr);
  for (const std::size_t bytes :
       {avr->flashend + std::size_t{1}, std::size_t{avr->ramend} - std::size_t{avr->ioend},
        avr->e2end + std::size_t{1}})
    line += "\t" + std::to_string(bytes);
  line += "\t" + namesOf<avr_ioport_t>(*avr, "port") + "\t" + namesOf<avr_timer_t>(*avr, "timer") + "\t" +
          namesOf<avr_uart_t>(*avr, "uart") + "\n";
  avr_terminate(avr);
  return line;
}

/// Describes it in a process of its own: simavr falls over its own tables of some (ATmega64M1). Empty then.
std::string describeApart(const avr_kind_t& kind) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t pid = ::fork();
  if (pid < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (pid == 0) {
    const std::string line = describe(kind);
    const bool is_written = ::write(ends[1], line.data(), line.size()) == static_cast<ssize_t>(line.size());
    ::_exit(is_written ? 0 : 1);
  }
  ::close(ends[1]);
  std::string line;
  char block[512];
  for (ssize_t got = 0; (got = ::read(ends[0], block, sizeof block)) > 0;)
    line.append(block, static_cast<std::size_t>(got));
  ::close(ends[0]);
  int status = 0;
  ::waitpid(pid, &status, 0);
  return status == 0 ? line : std::string();
}

}  // namespace

std::string describeControllers(const std::string& name) {
  avr_global_logger_set(sayNothing);
  std::vector<std::string> lines;
  for (avr_kind_t** kind = avr_kind; *kind != nullptr; ++kind) {
    const bool is_asked =
        std::ranges::any_of((*kind)->names, [&](const char* own) { return own != nullptr && name == own; });
    if (!is_asked) continue;
    const std::string line = describeApart(**kind);
    if (!line.empty()) return line;
  }
  for (avr_kind_t** kind = avr_kind; *kind != nullptr; ++kind) lines.push_back(describeApart(**kind));
  std::ranges::sort(lines);
  std::string text;
  for (const std::string& line : lines) text += line;
  return text;
}

}  // namespace kerfbench::avr_child
