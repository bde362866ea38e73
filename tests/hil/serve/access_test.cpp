// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/hil/serve/served.h"

namespace kerfbench::serve {
namespace {

class AccessTest : public testing::Test {
 protected:
  [[nodiscard]] std::string origin(const std::string& host) const {
    return fmt::format("http://{}:{}", host, served_.port());
  }
  InstalledBench bench_;
  Served served_{bench_};
};

TEST_F(AccessTest, WithoutATokenThereIsOnlyThePage) {
  const Client stranger = served_.stranger();
  for (const char* target : {"/api/session", "/api/files", "/api/files/content?path=a", "/api/runs",
                             "/api/runs/1", "/api/runs/1/events", "/api/runs/1/trace",
                             "/api/trace?path=a.mcap", "/api/nothing", "/results/a/report.html", "/other"})
    EXPECT_EQ(stranger.get(target).status, 401) << target;
  EXPECT_EQ(stranger.post("/api/runs", R"({"scenario":"a.yaml"})").status, 401);
  EXPECT_EQ(stranger.put("/api/files?path=a.yaml", "a").status, 401);
  EXPECT_FALSE(std::filesystem::exists(bench_.path("work/a.yaml")));
  // The page itself has nothing of the user's.
  EXPECT_EQ(stranger.get("/").status, 200);
  EXPECT_EQ(stranger.get("/view?trace=a.mcap").status, 200);
  EXPECT_EQ(stranger.get("/window/main.js").status, 200);
}

TEST_F(AccessTest, ATokenLetsOneBrowserInOnce) {
  const std::string token = served_.token();
  Client client = served_.stranger();
  const Reply reply = client.ask({"GET", "/view?trace=a%20b.mcap&token=" + token, "", {}});
  EXPECT_EQ(reply.status, 303);
  EXPECT_EQ(reply.header("location"), "/view?trace=a%20b.mcap") << "the token stays in no history";
  EXPECT_THAT(reply.header("set-cookie"),
              testing::AllOf(testing::HasSubstr("HttpOnly"), testing::HasSubstr("SameSite=Strict"),
                             testing::HasSubstr("Path=/")));
  Client second = served_.stranger();
  EXPECT_EQ(second.logIn(token).status, 403);
  EXPECT_EQ(second.get(kSessionPath).status, 401);
  // The next token lets another one in.
  EXPECT_NE(served_.token(), token);
  EXPECT_EQ(second.logIn(served_.token()).status, 303);
  EXPECT_EQ(second.get(kSessionPath).status, 200);
}

TEST_F(AccessTest, WhoIsInAlreadyMayUseHisOldLink) {
  const std::string token = served_.token();
  Client client = served_.stranger();
  client.logIn(token);
  EXPECT_EQ(client.get("/?token=" + token).status, 303);
  EXPECT_EQ(client.get(kSessionPath).status, 200);
}

TEST_F(AccessTest, AWrongTokenLetsNobodyIn) {
  Client client = served_.stranger();
  std::string wrong = served_.token();
  wrong.back() = wrong.back() == 'a' ? 'b' : 'a';
  for (const std::string& token :
       {std::string(), std::string("x"), wrong, served_.token() + "a", std::string(5000, 'a')}) {
    const Reply reply = client.logIn(token);
    EXPECT_EQ(reply.status, 403) << token;
    EXPECT_EQ(reply.header("set-cookie"), "");
  }
  EXPECT_EQ(client.logIn(served_.token()).status, 303) << "the right one still does";
}

TEST_F(AccessTest, AWrongCookieIsNone) {
  const Client client = served_.client();
  for (const std::string& cookie : {std::string("kerfbench-1=x"), client.cookie() + "x",
                                    client.cookie().substr(0, 30), "x" + client.cookie(), std::string("=")})
    EXPECT_EQ(client.ask({"GET", kSessionPath, "", {{"Cookie", cookie}}}).status, 401) << cookie;
  EXPECT_EQ(
      client.ask({"GET", kSessionPath, "", {{"Cookie", "other=1; " + client.cookie() + "; more=2"}}}).status,
      200);
}

// A name of somebody else's that he lets point to 127.0.0.1: the browser takes its page for one of ours.
TEST_F(AccessTest, AServerOfAnotherNameIsNotThisOne) {
  const Client client = served_.client();
  const auto status = [&](const std::string& host) {
    return client.ask({"GET", kSessionPath, "", {{"Host", host}}}).status;
  };
  const std::string port = std::to_string(served_.port());
  EXPECT_EQ(status("evil.example:" + port), 421);
  EXPECT_EQ(status("127.0.0.1.evil.example:" + port), 421);
  EXPECT_EQ(status("127.0.0.1"), 421);
  EXPECT_EQ(status("127.0.0.1:1"), 421);
  EXPECT_EQ(status("192.168.0.1:" + port), 421);
  EXPECT_EQ(status(""), 400) << "without Host";
  EXPECT_EQ(status("localhost:" + port), 200);
  // Not even the page.
  EXPECT_EQ(client.ask({"GET", "/", "", {{"Host", "evil.example:" + port}}}).status, 421);
}

TEST_F(AccessTest, APageOfAnotherServerAsksNothing) {
  const Client client = served_.client();
  const auto status = [&](const std::string& from) {
    return client.ask({"GET", kSessionPath, "", {{"Origin", from}}}).status;
  };
  EXPECT_EQ(status("http://evil.example"), 403);
  EXPECT_EQ(status("null"), 403);
  EXPECT_EQ(status("http://127.0.0.1:1"), 403) << "another server of this computer";
  EXPECT_EQ(status(fmt::format("https://127.0.0.1:{}", served_.port())), 403);
  EXPECT_EQ(status(origin("localhost")), 403) << "another name than the one that was asked for";
  EXPECT_EQ(status(origin("127.0.0.1")), 200);
}

TEST_F(AccessTest, AChangeNeedsItsHeader) {
  const Client client = served_.client();
  for (const char* said : {"", "0", "true"}) {
    EXPECT_EQ(client.ask({"PUT", "/api/files?path=a.yaml", "a", {{"X-Kerfbench", said}}}).status, 403)
        << said;
    EXPECT_EQ(client.ask({"POST", "/api/runs", "{}", {{"X-Kerfbench", said}}}).status, 403) << said;
  }
  EXPECT_FALSE(std::filesystem::exists(bench_.path("work/a.yaml")));
  EXPECT_EQ(client.put("/api/files?path=a.yaml", "a").status, 200);
}

TEST_F(AccessTest, EveryAnswerTellsTheBrowserToBeStrict) {
  const Client client = served_.client();
  for (const char* target : {"/", kSessionPath, "/api/nothing", "/window/main.js"}) {
    const Reply reply = client.get(target);
    EXPECT_EQ(reply.header("x-content-type-options"), "nosniff") << target;
    EXPECT_EQ(reply.header("referrer-policy"), "no-referrer") << target;
    EXPECT_EQ(reply.header("cache-control"), "no-store") << target;
    EXPECT_EQ(reply.header("cross-origin-resource-policy"), "same-origin") << target;
    EXPECT_THAT(
        reply.header("content-security-policy"),
        testing::AllOf(testing::HasSubstr("default-src 'none'"), testing::HasSubstr("frame-ancestors 'none'"),
                       testing::Not(testing::HasSubstr("unsafe"))))
        << target;
  }
}

TEST_F(AccessTest, EachPageHasANonceOfItsOwn) {
  const Reply first = served_.stranger().get("/"), second = served_.stranger().get("/");
  EXPECT_NE(first.body, second.body);
  const std::string nonce = first.body.substr(first.body.rfind('>') + 1, 32);
  EXPECT_THAT(first.header("content-security-policy"), testing::HasSubstr("'nonce-" + nonce + "'"));
}

// A report's page has no cookie: it runs apart from the window. The word in its address is good for results
// alone.
TEST_F(AccessTest, ReportsRunApartAndGetTheirPictures) {
  std::filesystem::create_directories(bench_.path("work/results/label/run"));
  bench_.write("work/results/label/run/report.html", "<img src=board.png>");
  bench_.write("work/results/label/run/board.png", "picture");
  bench_.write("work/a.yaml", "mine");
  const Reply led = served_.client().get("/results/label/run/report.html");
  ASSERT_EQ(led.status, 303);
  const std::string address = led.header("location");
  const Client stranger = served_.stranger();
  const Reply report = stranger.get(address);
  EXPECT_EQ(report.status, 200);
  EXPECT_EQ(report.body, "<img src=board.png>");
  EXPECT_THAT(
      report.header("content-security-policy"),
      testing::AllOf(testing::StartsWith("sandbox "), testing::Not(testing::HasSubstr("allow-same-origin"))));
  const std::string folder = address.substr(0, address.rfind('/') + 1);
  EXPECT_EQ(stranger.get(folder + "board.png").body, "picture");
  const std::string key = address.substr(0, address.find('/', 10));
  for (const std::string& out :
       {key + "/../a.yaml", key + "/%2e%2e/a.yaml", key + "/..%2fa.yaml", key + "//etc/passwd", key + "/",
        key, std::string("/results/~/label/run/report.html"),
        std::string("/results/~x/label/run/report.html")})
    EXPECT_THAT(stranger.get(out).status, testing::AnyOf(400, 403, 404, 401)) << out;
  EXPECT_EQ(stranger.ask({"GET", kSessionPath, "", {{"X-Kerfbench", key}}}).status, 401);
}

TEST(RandomWord, IsNeverTheSame) {
  std::set<std::string> words;
  for (int i = 0; i < 1000; ++i) words.insert(randomWord());
  EXPECT_EQ(words.size(), 1000U);
  EXPECT_EQ(words.begin()->size(), 32U);
}

TEST(Loopback, IsToldFromOtherAddresses) {
  for (const char* own : {"127.0.0.1", "127.8.8.8", "::1"}) EXPECT_TRUE(isLoopback(own)) << own;
  for (const char* other : {"0.0.0.0", "::", "192.168.0.7", "localhost", ""})
    EXPECT_FALSE(isLoopback(other)) << other;
}

}  // namespace
}  // namespace kerfbench::serve
