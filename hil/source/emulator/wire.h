// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace kerfbench::emulator {

/// The bench has closed its end: time to go.
class EndOfRequests : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Message {
  std::uint8_t type{};
  std::span<const std::uint8_t> payload;  ///< Until the next one is asked for.
};

/// Requests of the bench, one by one.
class Requests {
 public:
  /// Nobody else may read from `fd`: what is there is fetched at once.
  explicit Requests(int fd) : fd_(fd) {}
  /// The next framed message. @throws EndOfRequests at end of file, std::runtime_error on a malformed frame.
  Message next();
  /// Whether the next message has been fetched with the ones before it.
  [[nodiscard]] bool hasNext() const;

 private:
  [[nodiscard]] std::span<const std::uint8_t> rest() const {
    return std::span(buffer_).subspan(begin_, end_ - begin_);
  }
  void need(std::size_t bytes);

  int fd_;
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(65536);
  std::size_t begin_{}, end_{};  ///< What has been fetched and nobody has taken.
};

/// Replies to the bench, which are kept until they are sent.
class Replies {
 public:
  explicit Replies(int fd) : fd_(fd) {}
  /// Begins a message; what is put into the returned bytes is its payload, until end().
  std::vector<std::uint8_t>& begin(std::uint8_t type);
  void end();
  /// @throws EndOfRequests if the bench no longer listens.
  void send();
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

 private:
  int fd_;
  std::vector<std::uint8_t> bytes_;
  std::size_t begun_at_{};
};

/// Little-endian fields out of a payload, in order. @throws std::runtime_error past the end.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <typename T>
  T integer() {
    need(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) value |= std::uint64_t{bytes_[at_ + i]} << (8 * i);
    at_ += sizeof(T);
    return static_cast<T>(value);
  }
  std::string text() {
    const auto size = integer<std::uint16_t>();
    need(size);
    std::string result(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                       bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
    at_ += size;
    return result;
  }
  [[nodiscard]] bool atEnd() const { return at_ == bytes_.size(); }
  void finish() const {
    if (!atEnd()) throw std::runtime_error("a request has bytes left over");
  }

 private:
  void need(std::size_t count) const {
    if (bytes_.size() - at_ < count) throw std::runtime_error("a request is too short");
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t at_{};
};

/// Little-endian bytes of an integer. Returns the end of them.
template <typename T>
std::uint8_t* storeInteger(std::uint8_t* at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    at[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
  return at + sizeof(T);
}

template <typename T>
void putInteger(std::vector<std::uint8_t>& out, T value) {
  out.resize(out.size() + sizeof(T));
  storeInteger(out.data() + out.size() - sizeof(T), value);
}
inline void putText(std::vector<std::uint8_t>& out, std::string_view text) {
  text = text.substr(0, 0xFFFF);
  putInteger(out, static_cast<std::uint16_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}

}  // namespace kerfbench::emulator
