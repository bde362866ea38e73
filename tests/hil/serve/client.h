// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "hil/base/unique_fd.h"

namespace kerfbench::serve {

/// A net against hangs: no test waits for this long unless it fails.
inline constexpr int kPatience_ms = 60'000;

/// What anybody who was let in may ask.
inline constexpr const char* kSessionPath = "/api/session";

/// An answer as a client reads it.
struct Reply {
  int status{};
  std::map<std::string, std::string> headers;  ///< Names in lower case.
  std::string body;                            ///< Chunks are put together.

  [[nodiscard]] std::string header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? "" : found->second;
  }
};

/// Puts together what came in chunks, as far as it came; `is_whole`: with the last one.
inline std::string unchunked(std::string_view text, bool* is_whole = nullptr) {
  std::string body;
  if (is_whole != nullptr) *is_whole = false;
  while (true) {
    const auto end = text.find("\r\n");
    if (end == std::string_view::npos) return body;
    const std::size_t size = std::strtoul(std::string(text.substr(0, end)).c_str(), nullptr, 16);
    text.remove_prefix(end + 2);
    if (size == 0) {
      if (is_whole != nullptr) *is_whole = true;
      return body;
    }
    body += text.substr(0, size);
    if (text.size() < size + 2) return body;
    text.remove_prefix(size + 2);
  }
}

/// A connection that sends what it is told, byte by byte if need be.
class RawClient {
 public:
  explicit RawClient(int port, const char* address = "127.0.0.1")
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    ::inet_pton(AF_INET, address, &to.sin_addr);
    is_connected_ = ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }

  [[nodiscard]] bool isConnected() const { return is_connected_; }
  /// False: the server has closed the connection.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  /// Reads until `end` was read, or the server closes. What was read.
  const std::string& readUntil(std::string_view end) {
    while (end.empty() || read_.find(end) == std::string::npos) {
      if (!readSome()) break;
    }
    return read_;
  }
  const std::string& readToTheEnd() { return readUntil(""); }
  /// False: the server has closed, or nothing came.
  bool readSome() {
    pollfd poller{socket_.get(), POLLIN, 0};
    if (::poll(&poller, 1, kPatience_ms) <= 0) {
      ADD_FAILURE() << "the server neither answers nor closes";
      return false;
    }
    std::array<char, 64 * 1024> block{};
    const ssize_t got = ::recv(socket_.get(), block.data(), block.size(), 0);
    if (got > 0) read_.append(block.data(), static_cast<std::size_t>(got));
    return got > 0;
  }
  [[nodiscard]] const std::string& hasRead() const { return read_; }
  void close() { socket_.reset(); }

 private:
  base::UniqueFd socket_;
  bool is_connected_{};
  std::string read_;
};

/// The first answer in what was read.
inline Reply replyIn(const std::string& text) {
  Reply reply;
  const auto end = text.find("\r\n\r\n");
  if (end == std::string::npos || !text.starts_with("HTTP/1.1 ")) return reply;
  reply.status = std::atoi(text.c_str() + 9);
  for (std::size_t at = text.find("\r\n") + 2; at < end;) {
    const std::size_t stop = text.find("\r\n", at);
    const std::size_t colon = text.find(": ", at);
    std::string name = text.substr(at, colon - at);
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    reply.headers[name] = text.substr(colon + 2, stop - colon - 2);
    at = stop + 2;
  }
  reply.body = text.substr(end + 4);
  if (reply.header("transfer-encoding") == "chunked") reply.body = unchunked(reply.body);
  return reply;
}

/// What a browser would send, and what somebody else may.
struct Question {
  std::string method{"GET"}, target{"/"}, body{};
  std::map<std::string, std::string> headers{};
};

/// A client of one server, with or without its cookie.
class Client {
 public:
  explicit Client(int port) : port_(port) {}

  /// Uses a token; the answer to it.
  Reply logIn(const std::string& token) {
    Reply reply = ask({"GET", "/?token=" + token, "", {}});
    const std::string cookie = reply.header("set-cookie");
    cookie_ = cookie.substr(0, cookie.find(';'));
    return reply;
  }
  [[nodiscard]] const std::string& cookie() const { return cookie_; }
  [[nodiscard]] int port() const { return port_; }

  /// The request as text. A header given with the question takes the place of the client's own; an empty one
  /// leaves it out.
  [[nodiscard]] std::string text(const Question& question) const {
    std::map<std::string, std::string> headers{{"Host", fmt::format("127.0.0.1:{}", port_)},
                                               {"Connection", "close"}};
    if (!cookie_.empty()) headers["Cookie"] = cookie_;
    if (question.method == "POST" || question.method == "PUT") {
      headers["X-Kerfbench"] = "1";
      headers["Content-Length"] = std::to_string(question.body.size());
    }
    for (const auto& [name, value] : question.headers) headers[name] = value;
    std::string text = fmt::format("{} {} HTTP/1.1\r\n", question.method, question.target);
    for (const auto& [name, value] : headers)
      if (!value.empty()) text += name + ": " + value + "\r\n";
    return text + "\r\n" + question.body;
  }
  [[nodiscard]] Reply ask(const Question& question) const {
    RawClient raw(port_);
    if (!raw.isConnected()) return {};
    (void)raw.send(text(question));
    return replyIn(raw.readToTheEnd());
  }
  [[nodiscard]] Reply get(const std::string& target) const { return ask({"GET", target, "", {}}); }
  [[nodiscard]] Reply put(const std::string& target, const std::string& body) const {
    return ask({"PUT", target, body, {}});
  }
  [[nodiscard]] Reply post(const std::string& target, const std::string& body) const {
    return ask({"POST", target, body, {}});
  }

 private:
  int port_;
  std::string cookie_;
};

}  // namespace kerfbench::serve
