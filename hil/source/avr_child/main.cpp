// SPDX-License-Identifier: GPL-3.0-or-later
// kerfbench-avr: runs an AVR release image under simavr and speaks the pin-stream protocol on file
// descriptors 0 and 1.
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <memory>
#include <span>

#include "hil/source/avr_child/controllers.h"
#include "hil/source/avr_child/machine.h"
#include "hil/source/avr_child/wire.h"
#include "hil/source/pin_stream.h"

namespace {

using namespace kerfbench::avr_child;

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  (void)::setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

// An untrusted image runs in this process: let a fault of the emulator not grow into more.
void confine() {
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  (void)::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  (void)::signal(SIGPIPE, SIG_IGN);
  (void)::signal(SIGXFSZ, SIG_IGN);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
#ifndef KERFBENCH_SANITIZED  // The sanitizers' shadow alone takes terabytes of addresses.
  constexpr rlim_t kMaxAddressSpace = 1U << 30U;
  limit(RLIMIT_AS, kMaxAddressSpace);
#endif
}

std::vector<std::uint8_t> hello(const Machine& machine, std::uint64_t clock_hz) {
  constexpr std::uint32_t kStampError =
      2;  // the store's cycle inside its instruction, and the interrupt's latency
  std::vector<std::uint8_t> out;
  putInteger<std::uint32_t>(out, KB_PS_VERSION);
  putInteger<std::uint64_t>(out, 1);
  putInteger<std::uint64_t>(out, clock_hz);
  putInteger<std::uint32_t>(out, kStampError);
  putText(out, machine.configuration());
  return out;
}

std::vector<std::uint8_t> batch(const RunResult& run) {
  std::vector<std::uint8_t> out;
  out.reserve(32 + run.events.size() * 16 + run.uart.size() + run.message.size());
  putInteger(out, static_cast<std::uint8_t>(run.stop));
  putInteger(out, run.watermark);
  putInteger(out, static_cast<std::uint32_t>(run.events.size()));
  for (const auto& event : run.events) {
    putInteger(out, event.tick);
    putInteger(out, event.port);
    putInteger(out, event.changed);
    putInteger(out, event.level);
    putInteger(out, std::uint16_t{0});
  }
  putInteger(out, static_cast<std::uint32_t>(run.uart.size()));
  out.insert(out.end(), run.uart.begin(), run.uart.end());
  putText(out, run.message);
  return out;
}

std::unique_ptr<Machine> open(const Message& request, MachineOptions& options) {
  if (request.type != KB_PS_OPEN) throw std::runtime_error("the first request must be OPEN");
  FieldReader in(request.payload);
  const auto version = in.integer<std::uint32_t>();
  if (version != KB_PS_VERSION)
    throw std::runtime_error("protocol version " + std::to_string(version) + " is not known");
  options.clock_hz = in.integer<std::uint64_t>();
  options.baud = in.integer<std::uint32_t>();
  // What fits into a reply.
  options.max_events =
      std::min<std::uint64_t>(in.integer<std::uint64_t>(), (KB_PS_MAX_PAYLOAD - (1U << 20U)) / 16);
  options.mcu = in.text();
  options.image_path = in.text();
  if (!in.atEnd()) options.eeprom = in.text();
  in.finish();
  return std::make_unique<Machine>(options);
}

/// Serves requests until QUIT.
void serve(int in_fd, int out_fd) {
  MachineOptions options;
  std::unique_ptr<Machine> machine;
  Requests requests(in_fd);
  try {
    const Message first = requests.next();
    if (first.type == KB_PS_DESCRIBE) {
      std::vector<std::uint8_t> out;
      FieldReader in(first.payload);
      putText(out, describeControllers(in.text()));
      in.finish();
      writeMessage(out_fd, KB_PS_DESCRIPTION, out);
      return;
    }
    machine = open(first, options);
  } catch (const EndOfRequests&) {
    throw;
  } catch (const std::exception& fault) {
    std::vector<std::uint8_t> out;
    putText(out, fault.what());
    writeMessage(out_fd, KB_PS_ERROR, out);
    return;
  }
#ifndef KERFBENCH_SANITIZED
  limit(RLIMIT_NOFILE, 3);  // The image is read: no file or socket can be opened from here on.
#endif
  writeMessage(out_fd, KB_PS_HELLO, hello(*machine, options.clock_hz));
  for (;;) {
    const Message request = requests.next();
    FieldReader in(request.payload);
    switch (request.type) {
      case KB_PS_DRIVE: {
        const auto tick = in.integer<std::uint64_t>();
        const auto port = in.integer<std::uint16_t>();
        const auto bit = in.integer<std::uint16_t>();
        const auto level = in.integer<std::uint8_t>();
        in.finish();
        machine->drive(tick, port, bit, level != 0);
        break;
      }
      case KB_PS_UART:
        machine->send(request.payload);
        break;
      case KB_PS_ADVANCE: {
        const auto until = in.integer<std::uint64_t>();
        in.finish();
        const RunResult run = machine->run(until);
        writeMessage(out_fd, KB_PS_BATCH, batch(run));
        if (run.stop != KB_PS_REACHED) return;
        break;
      }
      case KB_PS_QUIT:
        return;
      default:
        throw std::runtime_error("request " + std::to_string(request.type) + " is not known");
    }
  }
}

}  // namespace

#ifdef KERFBENCH_SANITIZED
// simavr frees little of what it takes; the end of this process frees it all. A leak of our own is still
// told. NOLINTNEXTLINE(bugprone-reserved-identifier): the sanitizer's name for it
extern "C" const char* __lsan_default_suppressions() { return "leak:libsimavr\n"; }
#endif

int main() {
  // simavr prints to stdout now and then: keep the protocol's descriptors to ourselves.
  const int in_fd = ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
  const int out_fd = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  const int null_fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (in_fd < 0 || out_fd < 0 || null_fd < 0 || ::dup2(null_fd, STDIN_FILENO) < 0 ||
      ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    std::perror("kerfbench-avr");
    return 1;
  }
  ::close(null_fd);
  confine();
  try {
    serve(in_fd, out_fd);
  } catch (const EndOfRequests&) {
    return 0;
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "kerfbench-avr: %s\n", fault.what());
    return 1;
  }
  return 0;
}
