// SPDX-License-Identifier: GPL-3.0-or-later
// kerfbench-sigrok: samples a logic analyser through libsigrok; see analyser_stream.h.
#include <signal.h>
#include <sys/prctl.h>

#include <charconv>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "hil/source/analyser/sigrok_child/sigrok.h"

namespace {

using namespace kerfbench::sigrok_child;

void send(Frame frame, const std::string& payload) {
  std::string bytes(1, static_cast<char>(frame));
  for (unsigned i = 0; i < 4; ++i) bytes += static_cast<char>(payload.size() >> (8 * i));
  bytes += payload;
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size() || std::fflush(stdout) != 0)
    throw std::runtime_error("nobody listens any more");
}

std::uint64_t numberOf(const std::string& text) {
  std::uint64_t value{};
  const auto done = std::from_chars(text.data(), text.data() + text.size(), value);
  if (done.ec != std::errc{} || done.ptr != text.data() + text.size() || value == 0)
    throw SigrokError("'" + text + "' is no number");
  return value;
}

void take(const std::string& key, const std::string& value, AcquireRequest& request) {
  if (key == "driver") {
    request.driver = value;
  } else if (key == "conn") {
    request.conn = value;
  } else if (key == "serial") {
    request.serial = value;
  } else if (key == "samplerate") {
    request.samplerate_hz = numberOf(value);
  } else if (key == "quiet") {
    request.listen.quiet_samples = numberOf(value);
  } else if (key == "limit") {
    request.listen.limit_samples = numberOf(value);
  } else if (key == "channel") {
    request.channels.push_back(value);
  } else if (const auto equals = value.find('='); key == "setting" && equals != std::string::npos) {
    request.settings.emplace_back(value.substr(0, equals), value.substr(equals + 1));
  } else {
    throw SigrokError("a request with '" + key + "' is not understood");
  }
}

void serve() {
  std::string line;
  std::getline(std::cin, line);
  if (line == "list") return listAnalysers(send);
  if (line != "acquire") throw SigrokError("neither list nor acquire is asked for");
  AcquireRequest request;
  while (std::getline(std::cin, line) && !line.empty()) {
    const auto blank = line.find(' ');
    take(line.substr(0, blank), blank == std::string::npos ? "" : line.substr(blank + 1), request);
  }
  if (request.samplerate_hz == 0 || request.listen.quiet_samples == 0 || request.listen.limit_samples == 0)
    throw SigrokError("a request without samplerate, quiet or limit");
  acquire(request, send);
}

}  // namespace

int main() {
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  (void)::signal(SIGPIPE, SIG_IGN);
  try {
    serve();
    return 0;
  } catch (const SigrokError& e) {
    try {
      send(Frame::kError, e.what());
      return 1;
    } catch (const std::exception&) {
      return 2;
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "kerfbench-sigrok: %s\n", e.what());
    return 2;
  }
}
