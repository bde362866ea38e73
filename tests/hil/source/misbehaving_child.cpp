// SPDX-License-Identifier: Apache-2.0
// A child that breaks the pin-stream protocol in the manner that the image's name states.
#include <fcntl.h>
#include <net/if.h>
#include <signal.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "hil/source/pin_stream.h"

namespace {

std::vector<std::uint8_t> payload;

template <typename T>
void put(T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    payload.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
  }
}

void send(std::uint8_t type, std::uint32_t claimed_extra = 0) {
  std::vector<std::uint8_t> frame;
  const auto size = static_cast<std::uint32_t>(payload.size()) + claimed_extra;
  for (unsigned i = 0; i < 4; ++i) frame.push_back(static_cast<std::uint8_t>(size >> (8 * i)));
  frame.push_back(type);
  frame.insert(frame.end(), payload.begin(), payload.end());
  if (::write(1, frame.data(), frame.size()) < 0) std::perror("write");
  payload.clear();
}

std::string request() {
  std::uint8_t head[5];
  for (std::size_t at = 0; at < 5;) {
    const auto got = ::read(0, head + at, 5 - at);
    if (got <= 0) ::_exit(0);
    at += static_cast<std::size_t>(got);
  }
  std::string body(head[0] | static_cast<unsigned>(head[1]) << 8U, '\0');
  for (std::size_t at = 0; at < body.size();) {
    const auto got = ::read(0, body.data() + at, body.size() - at);
    if (got <= 0) ::_exit(0);
    at += static_cast<std::size_t>(got);
  }
  return body;
}

void hello() {
  put(std::uint32_t{KB_PS_VERSION});
  put(std::uint64_t{1});
  put(std::uint64_t{1'000'000});
  put(std::uint32_t{0});
  put(std::uint16_t{0});
  send(KB_PS_HELLO);
}

void event(std::uint64_t tick, std::uint16_t changed, std::uint16_t level) {
  put(tick);
  put(std::uint16_t{0});
  put(changed);
  put(level);
  put(std::uint16_t{0});
}

void head(std::uint8_t stop, std::uint64_t watermark, std::uint32_t events) {
  put(stop);
  put(watermark);
  put(events);
}

void tail() {
  put(std::uint32_t{0});
  put(std::uint16_t{0});
  send(KB_PS_BATCH);
}

/// Says on standard error what of the computer it can see or change.
void lookAround() {
  const auto say = [](bool is, const char* what) {
    if (is) std::fprintf(stderr, "%s\n", what);
  };
  say(::open("/etc/passwd", O_RDONLY) >= 0, "reads accounts");
  say(std::getenv("HOME") != nullptr, "has an environment");
  say(::kill(::getppid(), 0) == 0 && ::getppid() > 1, "reaches the bench");
  say(::access("/proc/1/stat", R_OK) == 0, "sees processes");
  int devices = 0;
  if (struct if_nameindex* const names = ::if_nameindex(); names != nullptr) {
    for (const struct if_nameindex* name = names; name->if_index != 0; ++name) ++devices;
    ::if_freenameindex(names);
  }
  say(devices > 1, "has a network");
  const char* const file = KERFBENCH_SCRATCH "/escaped";
  say(::open(file, O_CREAT | O_WRONLY, 0600) >= 0, "writes files");
  ::unlink(file);
  std::fprintf(stderr, "has looked\n");
}

}  // namespace

int main() {
  const std::string open = request();
  const auto is = [&](const char* what) { return open.find(what) != std::string::npos; };
  if (is("dies-at-once")) return 7;
  if (is("wrong-version")) {
    put(std::uint32_t{99});
    send(KB_PS_HELLO);
    return 0;
  }
  if (is("silent")) {
    for (;;) ::pause();
  }
  hello();
  request();
  if (is("dies-by-signal")) {
    std::fprintf(stderr, "first words\nlast words\n");
    ::signal(SIGSEGV, SIG_DFL);  // A sanitizer may have its own handler.
    ::raise(SIGSEGV);
  }
  if (is("looks-around")) {
    lookAround();
    return 4;
  }
  if (is("leaves-children")) {
    if (::fork() == 0) {
      for (;;) ::pause();
    }
    return 5;
  }
  if (is("uart-flood")) {
    head(KB_PS_REACHED, 100, 0);
    put(std::uint32_t{2U << 20U});
    payload.resize(payload.size() + (2U << 20U));
    put(std::uint16_t{0});
    send(KB_PS_BATCH);
  }
  if (is("hangs")) {
    for (;;) ::pause();
  }
  if (is("huge-length")) send(KB_PS_BATCH, 0xF0000000U);
  if (is("cut-off")) {
    head(KB_PS_REACHED, 100, 0);
    send(KB_PS_BATCH, 1000);
    return 3;
  }
  if (is("unknown-reply")) send(99);
  if (is("unknown-stop")) head(77, 100, 0), tail();
  if (is("wrong-watermark")) head(KB_PS_REACHED, 50, 0), tail();
  if (is("late-watermark")) head(KB_PS_ENDED, 101, 0), tail();
  if (is("too-many")) head(KB_PS_REACHED, 100, 0xFFFFFFFFU), tail();
  if (is("fewer-than-said")) head(KB_PS_REACHED, 100, 3), event(1, 1, 1), tail();
  if (is("descending")) head(KB_PS_REACHED, 100, 2), event(9, 1, 1), event(8, 1, 0), tail();
  if (is("beyond")) head(KB_PS_REACHED, 100, 1), event(101, 1, 1), tail();
  if (is("contradiction")) head(KB_PS_REACHED, 100, 2), event(8, 1, 1), event(9, 2, 2), tail();
  if (is("back-at-once")) head(KB_PS_REACHED, 100, 2), event(8, 1, 1), event(8, 1, 0), tail();
  if (is("left-over")) {
    head(KB_PS_REACHED, 100, 0);
    put(std::uint32_t{0});
    put(std::uint16_t{0});
    put(std::uint64_t{0});
    send(KB_PS_BATCH);
  }
  if (is("talkative")) {
    const std::string words(100'000, 'w');
    for (int i = 0; i < 20; ++i) std::fprintf(stderr, "%s\n", words.c_str());
    head(KB_PS_REACHED, 100, 0);
    tail();
  }
  request();
  for (;;) ::pause();  // The pause also outlasts QUIT.
}
