// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/http_head.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "hil/serve/refusal.h"

namespace kerfbench::serve {
namespace {

HttpHead read(const std::string& lines) { return parseHead(lines + "\r\n"); }

/// Status of the refusal; 0: it was taken.
int refusalOf(const std::string& lines) {
  try {
    (void)read(lines);
  } catch (const Refusal& refusal) {
    EXPECT_STRNE(refusal.what(), "");
    return refusal.status();
  }
  return 0;
}

TEST(HttpHead, OfABrowserIsRead) {
  const HttpHead head = read(
      "GET /api/files/content?path=a%20b%2Fc.dxf&x=1+2 HTTP/1.1\r\nHost: 127.0.0.1:8080\r\n"
      "Cookie: a=b; c=d\r\nRange:bytes=1-2\r\nConnection: keep-alive\r\n");
  EXPECT_EQ(head.method, "GET");
  EXPECT_EQ(head.path, "/api/files/content");
  EXPECT_THAT(head.query,
              testing::UnorderedElementsAre(testing::Pair("path", "a b/c.dxf"), testing::Pair("x", "1 2")));
  EXPECT_EQ(*head.header("range"), "bytes=1-2");
  EXPECT_EQ(head.header("origin"), nullptr);
  EXPECT_TRUE(head.keep_alive);
  EXPECT_FALSE(read("GET / HTTP/1.1\r\nConnection: Close\r\n").keep_alive);
  EXPECT_EQ(read("PUT /a HTTP/1.1\r\nContent-Length: 12\r\n").body_bytes, 12U);
}

// Two readers of one request must never find two requests in it: what cpp-httplib 0.11.4 or a proxy may read
// in another way is refused.
TEST(HttpHead, ThatCanBeReadInTwoWaysIsRefused) {
  const std::string get = "GET / HTTP/1.1\r\n";
  EXPECT_EQ(refusalOf("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n"), 501);
  EXPECT_EQ(refusalOf("POST / HTTP/1.1\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n"), 501);
  EXPECT_EQ(refusalOf("POST / HTTP/1.1\r\nContent-Length: 3\r\nContent-Length: 4\r\n"), 400);
  EXPECT_EQ(refusalOf("POST / HTTP/1.1\r\nContent-Length: 3, 3\r\n"), 400);
  EXPECT_EQ(refusalOf("POST / HTTP/1.1\r\nContent-Length: -1\r\n"), 400);
  EXPECT_EQ(refusalOf("POST / HTTP/1.1\r\nContent-Length: 0x10\r\n"), 400);
  EXPECT_EQ(refusalOf("POST / HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n"), 400);
  EXPECT_EQ(refusalOf("POST / HTTP/1.1\r\n"), 411);
  EXPECT_EQ(refusalOf("GET / HTTP/1.1\r\nContent-Length: 3\r\n"), 400);
  EXPECT_EQ(refusalOf(get + "A: b\r\n folded\r\n"), 400);
  EXPECT_EQ(refusalOf(get + "A : b\r\n"), 400);
  EXPECT_EQ(refusalOf(get + ": b\r\n"), 400);
  EXPECT_EQ(refusalOf(get + "Host: a\r\nhost: b\r\n"), 400);
  EXPECT_EQ(refusalOf(get + "A: b\nC: d\r\n"), 400);
  EXPECT_EQ(refusalOf(get + "A: b\rc\r\n"), 400);
  EXPECT_EQ(refusalOf(get + std::string("A: b\0c\r\n", 8)), 400);
}

TEST(HttpHead, OfSomethingElseIsRefused) {
  EXPECT_EQ(refusalOf("\x16\x03\x01 hello\r\n"), 400);
  EXPECT_EQ(refusalOf("GET /\r\n"), 400);
  EXPECT_EQ(refusalOf("GET / HTTP/1.0\r\n"), 505);
  EXPECT_EQ(refusalOf("GET / HTTP/2\r\n"), 505);
  EXPECT_EQ(refusalOf("DELETE / HTTP/1.1\r\n"), 405);
  EXPECT_EQ(refusalOf("CONNECT example.org:80 HTTP/1.1\r\n"), 405);
  EXPECT_EQ(refusalOf("GET http://example.org/ HTTP/1.1\r\n"), 400);
  EXPECT_EQ(refusalOf("GET /a b HTTP/1.1\r\n"), 400);
  EXPECT_EQ(refusalOf("GET /%zz HTTP/1.1\r\n"), 400);
  EXPECT_EQ(refusalOf("GET /%00 HTTP/1.1\r\n"), 400);
  EXPECT_EQ(refusalOf("GET /a%0d%0ab HTTP/1.1\r\n"), 400);
  EXPECT_EQ(refusalOf("GET /?a=1&a=2 HTTP/1.1\r\n"), 400);
  EXPECT_EQ(refusalOf("GET /" + std::string(kMostPathBytes, 'a') + " HTTP/1.1\r\n"), 414);
  EXPECT_EQ(refusalOf("GET /?" + std::string(kMostQueryBytes + 1, 'a') + " HTTP/1.1\r\n"), 414);
  std::string many = "GET / HTTP/1.1\r\n";
  for (std::size_t i = 0; i <= kMostHeaders; ++i) many += "H" + std::to_string(i) + ": x\r\n";
  EXPECT_EQ(refusalOf(many), 431);
  EXPECT_EQ(refusalOf("GET / HTTP/1.1\r\nA: " + std::string(kMostHeadBytes, 'a') + "\r\n"), 431);
}

TEST(HttpHead, EncodedTextIsDecodedToItself) {
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  EXPECT_EQ(percentDecoded(percentEncoded(all), false), all);
  EXPECT_EQ(percentDecoded(percentEncoded(all), true), all);
  EXPECT_EQ(percentDecoded("100%", false), std::nullopt);
}

}  // namespace
}  // namespace kerfbench::serve
