// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/run_child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <vector>

#include "hil/source/emulator/sandbox.h"
#include "hil/source/emulator/wire.h"

namespace kerfbench::emulator {
namespace {

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  (void)::setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

// An untrusted image runs in this process: let a fault of the emulator not grow into more.
void confine([[maybe_unused]] std::uint64_t address_space_bytes) {
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  (void)::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  (void)::signal(SIGPIPE, SIG_IGN);
  (void)::signal(SIGXFSZ, SIG_IGN);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
#ifndef KERFBENCH_SANITIZED  // The sanitizers' shadow alone takes terabytes of addresses.
  limit(RLIMIT_AS, address_space_bytes);
#endif
}

// Replies wait for those to the requests behind them as long as they do not fill the pipe.
constexpr std::size_t kHeldBytes = 32768;
constexpr std::size_t kEventBytes = 16;

void putHello(Replies& replies, const Emulator& emulator) {
  const Clock clock = emulator.clock();
  auto& out = replies.begin(KB_PS_HELLO);
  putInteger<std::uint32_t>(out, KB_PS_VERSION);
  putInteger(out, clock.tick_num);
  putInteger(out, clock.tick_den);
  putInteger(out, clock.stamp_error_ticks);
  putText(out, emulator.configuration());
  replies.end();
}

void putEvents(std::vector<std::uint8_t>& out, const std::vector<PinEvent>& events) {
  putInteger(out, static_cast<std::uint32_t>(events.size()));
  out.resize(out.size() + events.size() * kEventBytes);
  std::uint8_t* at = out.data() + out.size() - events.size() * kEventBytes;
  for (const auto& event : events) {
    at = storeInteger(at, event.tick);
    at = storeInteger(at, event.port);
    at = storeInteger(at, event.changed);
    at = storeInteger(at, event.level);
    at = storeInteger(at, std::uint16_t{0});
  }
}

void putBatch(Replies& replies, const RunResult& run) {
  auto& out = replies.begin(KB_PS_BATCH);
  putInteger(out, static_cast<std::uint8_t>(run.stop));
  putInteger(out, run.watermark);
  putEvents(out, run.events);
  putInteger(out, static_cast<std::uint32_t>(run.uart.size()));
  out.insert(out.end(), run.uart.begin(), run.uart.end());
  putText(out, run.message);
  replies.end();
}

OpenRequest openRequest(const Message& request) {
  if (request.type != KB_PS_OPEN) throw std::runtime_error("the first request must be OPEN");
  FieldReader in(request.payload);
  const auto version = in.integer<std::uint32_t>();
  if (version != KB_PS_VERSION)
    throw std::runtime_error("protocol version " + std::to_string(version) + " is not known");
  OpenRequest asked;
  asked.clock_hz = in.integer<std::uint64_t>();
  asked.baud = in.integer<std::uint32_t>();
  // What fits into a reply.
  asked.max_events =
      std::min<std::uint64_t>(in.integer<std::uint64_t>(), (KB_PS_MAX_PAYLOAD - (1U << 20U)) / 16);
  asked.mcu = in.text();
  asked.image_path = in.text();
  if (!in.atEnd()) asked.eeprom = in.text();
  in.finish();
  return asked;
}

void replyText(Replies& replies, kb_ps_reply type, std::string_view text) {
  putText(replies.begin(static_cast<std::uint8_t>(type)), text);
  replies.end();
  replies.send();
}

void drive(Emulator& emulator, const Message& request) {
  FieldReader in(request.payload);
  const auto tick = in.integer<std::uint64_t>();
  const auto port = in.integer<std::uint16_t>();
  const auto bit = in.integer<std::uint16_t>();
  const auto level = in.integer<std::uint8_t>();
  in.finish();
  emulator.drive(tick, port, bit, level != 0);
}

/// Answers requests until QUIT, or until the firmware's end. The bench may ask for several quanta at once.
void answer(Emulator& emulator, bool has_uart, Requests& requests, Replies& replies) {
  for (;;) {
    if (!requests.hasNext() || replies.size() > kHeldBytes) replies.send();
    const Message request = requests.next();
    switch (request.type) {
      case KB_PS_DRIVE:
        drive(emulator, request);
        break;
      case KB_PS_UART:
        if (!has_uart) throw std::runtime_error("bytes for a UART whose rate OPEN does not give (baud 0)");
        emulator.send(request.payload);
        break;
      case KB_PS_ADVANCE: {
        FieldReader in(request.payload);
        const auto until = in.integer<std::uint64_t>();
        in.finish();
        const RunResult run = emulator.run(until);
        putBatch(replies, run);
        if (run.stop == KB_PS_REACHED) break;
        replies.send();
        return;
      }
      case KB_PS_QUIT:
        replies.send();
        return;
      default:
        throw std::runtime_error("request " + std::to_string(request.type) + " is not known");
    }
  }
}

void serve(int in_fd, int out_fd, const Opener& open, const Describer& describe) {
  std::unique_ptr<Emulator> emulator;
  Requests requests(in_fd);
  Replies replies(out_fd);
  OpenRequest asked;
  try {
    const Message first = requests.next();
    if (first.type == KB_PS_DESCRIBE) {
      FieldReader in(first.payload);
      const std::string name = in.text();
      in.finish();
      replyText(replies, KB_PS_DESCRIPTION, describe(name));
      return;
    }
    asked = openRequest(first);
    emulator = open(asked);
  } catch (const EndOfRequests&) {
    throw;
  } catch (const std::exception& fault) {
    replyText(replies, KB_PS_ERROR, fault.what());
    return;
  }
#ifndef KERFBENCH_SANITIZED  // The sanitizers need system calls of their own.
  enterSandbox(in_fd, out_fd);
#endif
  putHello(replies, *emulator);
  replies.send();
  try {
    answer(*emulator, asked.baud != 0, requests, replies);
  } catch (...) {
    replies.send();  // What came before a request that cannot be answered.
    throw;
  }
}

}  // namespace

int runChild(std::string_view program, const Opener& open, const Describer& describe,
             std::uint64_t address_space_bytes) {
  const std::string name(program);
  // A library may print to standard output: keep the protocol's descriptors to ourselves.
  const int in_fd = ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
  const int out_fd = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  const int null_fd = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (in_fd < 0 || out_fd < 0 || null_fd < 0 || ::dup2(null_fd, STDIN_FILENO) < 0 ||
      ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    std::perror(name.c_str());
    return 1;
  }
  ::close(null_fd);
  confine(address_space_bytes);
  try {
    serve(in_fd, out_fd, open, describe);
  } catch (const EndOfRequests&) {
    return 0;
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), fault.what());
    return 1;
  }
  return 0;
}

}  // namespace kerfbench::emulator
