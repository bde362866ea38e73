// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#include "hil/source/emulator/wire.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "hil/source/pin_stream.h"

namespace kerfbench::emulator {
namespace {

constexpr std::size_t kHeadBytes = 5;

std::uint32_t payloadBytes(std::span<const std::uint8_t> head) {
  std::uint32_t size = 0;
  for (unsigned i = 0; i < 4; ++i) size |= std::uint32_t{head[i]} << (8 * i);
  return size;
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

/// Fetches until so many bytes are there.
void Requests::need(std::size_t bytes) {
  if (end_ - begin_ >= bytes) return;
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
            buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
  end_ -= begin_;
  begin_ = 0;
  if (buffer_.size() < bytes) buffer_.resize(bytes);
  while (end_ < bytes) {
    const ssize_t got = ::read(fd_, buffer_.data() + end_, buffer_.size() - end_);
    if (got == 0) throw EndOfRequests("the bench has gone");
    if (got > 0) {
      end_ += static_cast<std::size_t>(got);
    } else if (errno != EINTR) {
      throw std::runtime_error(std::string("reading a request: ") + std::strerror(errno));
    }
  }
}

bool Requests::hasNext() const {
  return rest().size() >= kHeadBytes && rest().size() - kHeadBytes >= payloadBytes(rest());
}

Message Requests::next() {
  need(kHeadBytes);
  const std::uint32_t size = payloadBytes(rest());
  if (size > KB_PS_MAX_PAYLOAD) throw std::runtime_error("a request is too long");
  need(kHeadBytes + size);
  const Message message{rest()[4], rest().subspan(kHeadBytes, size)};
  begin_ += kHeadBytes + size;
  return message;
}

std::vector<std::uint8_t>& Replies::begin(std::uint8_t type) {
  begun_at_ = bytes_.size();
  bytes_.resize(begun_at_ + kHeadBytes);
  bytes_.back() = type;
  return bytes_;
}

void Replies::end() {
  storeInteger(bytes_.data() + begun_at_, static_cast<std::uint32_t>(bytes_.size() - begun_at_ - kHeadBytes));
}

void Replies::send() {
  writeAll(fd_, bytes_);
  bytes_.clear();
}

}  // namespace kerfbench::emulator
