// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/wire.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>

#include "hil/source/pin_stream.h"

namespace kerfbench::avr_child {
namespace {

void readAll(int fd, std::span<std::uint8_t> into) {
  for (std::size_t done = 0; done < into.size();) {
    const ssize_t got = ::read(fd, into.data() + done, into.size() - done);
    if (got > 0) {
      done += static_cast<std::size_t>(got);
    } else if (got == 0) {
      throw EndOfRequests("the bench has gone");
    } else if (errno != EINTR) {
      throw std::runtime_error(std::string("reading a request: ") + std::strerror(errno));
    }
  }
}

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

Message readMessage(int fd) {
  std::uint8_t head[5];
  readAll(fd, head);
  std::uint32_t size = 0;
  for (unsigned i = 0; i < 4; ++i) size |= std::uint32_t{head[i]} << (8 * i);
  if (size > KB_PS_MAX_PAYLOAD) throw std::runtime_error("a request is too long");
  Message message{head[4], std::vector<std::uint8_t>(size)};
  readAll(fd, message.payload);
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

}  // namespace kerfbench::avr_child
