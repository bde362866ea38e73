// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/neighbours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "hil/base/input_error.h"
#include "tests/hil/serve/served.h"

namespace kerfbench::serve {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// Somebody else who listens: says these words to the first client, and closes.
class OtherServer {
 public:
  explicit OtherServer(std::string words)
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)), words_(std::move(words)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&at), size), 0);
    EXPECT_EQ(::listen(socket_.get(), 4), 0);
    EXPECT_EQ(::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&at), &size), 0);
    port_ = ntohs(at.sin_port);
    thread_ = std::thread([this] {
      const base::UniqueFd client(::accept(socket_.get(), nullptr, nullptr));
      std::array<char, 4096> question{};
      (void)!::recv(client.get(), question.data(), question.size(), 0);
      std::string_view left = words_;
      while (!left.empty()) {
        const ssize_t sent = ::send(client.get(), left.data(), left.size(), MSG_NOSIGNAL);
        if (sent <= 0) break;
        left.remove_prefix(static_cast<std::size_t>(sent));
      }
    });
  }
  ~OtherServer() {
    ::shutdown(socket_.get(), SHUT_RDWR);
    thread_.join();
  }
  OtherServer(const OtherServer&) = delete;
  OtherServer& operator=(const OtherServer&) = delete;
  [[nodiscard]] BenchAddress address() const { return {"127.0.0.1", port_, "a-token-of-its-own"}; }

 private:
  base::UniqueFd socket_;
  std::string words_;
  int port_{};
  std::thread thread_;
};

std::string problemOf(const BenchAddress& address) {
  Neighbours neighbours({address});
  return neighbours.json()[0].value("problem", "");
}

TEST(Neighbours, AreAskedByTheServerAndNotByTheBrowser) {
  const InstalledBench bench;
  bench.write("work/a.yaml", "name: a\n");
  const Served other(bench);
  const Client there = other.client();
  const std::string id = Json::parse(
      there.post("/api/runs", R"({"scenario":"a.yaml","trace":false,"serial_number":"K-7"})").body)["id"];
  (void)there.get("/api/runs/" + id + "/events");
  Neighbours neighbours({{"127.0.0.1", other.port(), other.token()}});
  const Json rows = neighbours.json();
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0]["address"], fmt::format("http://127.0.0.1:{}/", other.port()));
  EXPECT_EQ(rows[0]["runs"][0]["serial_number"], "K-7");
  EXPECT_EQ(rows[0]["folder"], "work");
  EXPECT_FALSE(rows[0].contains("problem"));
  EXPECT_EQ(neighbours.json(), rows) << "what is fresh is not asked for again";
}

TEST(Neighbours, ThatDoNotAnswerAreNamedWithTheReason) {
  const InstalledBench bench;
  int port = 0;
  {
    const Served other(bench);
    port = other.port();
    EXPECT_THAT(problemOf({"127.0.0.1", port, "not-the-token"}), HasSubstr("does not let this bench in"));
  }
  EXPECT_THAT(problemOf({"127.0.0.1", port, "a-token-of-its-own"}), HasSubstr("does not answer"));
  EXPECT_THAT(problemOf({"no-such-computer.invalid", 1, "a-token-of-its-own"}),
              HasSubstr("no computer of this name"));
}

TEST(Neighbours, WhateverTheySayIsBoundedAndData) {
  EXPECT_THAT(problemOf(OtherServer("SSH-2.0-OpenSSH_9.2\r\n").address()), HasSubstr("This is no bench"));
  EXPECT_THAT(problemOf(OtherServer("").address()), HasSubstr("This is no bench"));
  EXPECT_THAT(problemOf(OtherServer("HTTP/1.1 200 OK\r\n\r\n" + std::string(8U << 20U, 'x')).address()),
              HasSubstr("too much"));
  EXPECT_THAT(problemOf(OtherServer("HTTP/1.1 303 See\r\nLocation: http://evil.example/\r\n\r\n").address()),
              HasSubstr("does not let this bench in"));
}

TEST(Neighbours, AddressesAreThoseThatServePrints) {
  const BenchAddress v4 = benchAddressFrom("http://192.168.0.7:8080/?token=abc_DEF-123");
  EXPECT_EQ(v4.host, "192.168.0.7");
  EXPECT_EQ(v4.port, 8080);
  EXPECT_EQ(v4.token, "abc_DEF-123");
  EXPECT_EQ(benchAddressFrom("http://[::1]:80/?token=abcdefgh").host, "::1");
  for (const char* wrong : {"", "192.168.0.7:8080", "https://a:1/?token=abcdefgh", "http://a/?token=abcdefgh",
                            "http://a:0/?token=abcdefgh", "http://a:99999/?token=abcdefgh", "http://a:1/",
                            "http://a:1/?token=abc%0d%0adef", "http://a b:1/?token=abcdefgh",
                            "http://u:p@a:1/?token=abcdefgh", "http://a:1/?token=abcdefgh\r\nX: y"})
    EXPECT_THROW((void)benchAddressFrom(wrong), base::InputError) << wrong;
}

}  // namespace
}  // namespace kerfbench::serve
