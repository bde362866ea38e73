// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/wire.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "hil/source/pin_stream.h"

namespace kerfbench::emulator {
namespace {

void writeAll(int fd, std::span<const std::uint8_t> bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t put = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (put >= 0) {
      done += static_cast<std::size_t>(put);
    } else if (errno == EPIPE) {
      throw EndOfRequests("the bench has gone");
    } else if (errno != EINTR) {
      throw std::runtime_error(std::string("writing a reply: ") + std::strerror(errno));
    }
  }
}

}  // namespace

void Requests::fetch() {
  ssize_t got = 0;
  do {
    got = ::read(fd_, buffer_.data(), buffer_.size());
  } while (got < 0 && errno == EINTR);
  if (got == 0) throw EndOfRequests("the bench has gone");
  if (got < 0) throw std::runtime_error(std::string("reading a request: ") + std::strerror(errno));
  fetched_ = std::span(buffer_).first(static_cast<std::size_t>(got));
}

void Requests::readAll(std::span<std::uint8_t> into) {
  while (!into.empty()) {
    if (fetched_.empty()) fetch();
    const std::size_t taken = std::min(into.size(), fetched_.size());
    std::copy_n(fetched_.begin(), taken, into.begin());
    fetched_ = fetched_.subspan(taken);
    into = into.subspan(taken);
  }
}

Message Requests::next() {
  std::uint8_t head[5];
  readAll(head);
  std::uint32_t size = 0;
  for (unsigned i = 0; i < 4; ++i) size |= std::uint32_t{head[i]} << (8 * i);
  if (size > KB_PS_MAX_PAYLOAD) throw std::runtime_error("a request is too long");
  Message message{head[4], std::vector<std::uint8_t>(size)};
  readAll(message.payload);
  return message;
}

void writeMessage(int fd, std::uint8_t type, const std::vector<std::uint8_t>& payload) {
  std::vector<std::uint8_t> frame;
  frame.reserve(payload.size() + 5);
  putInteger(frame, static_cast<std::uint32_t>(payload.size()));
  frame.push_back(type);
  frame.insert(frame.end(), payload.begin(), payload.end());
  writeAll(fd, frame);
}

}  // namespace kerfbench::emulator
