// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/event_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace kerfbench::serve {
namespace {

const auto kHere = [] { return false; };

std::string toldBy(EventStream& stream, std::uint64_t after = 0) {
  stream.end();
  const auto body = eventBody(std::shared_ptr<EventStream>(std::shared_ptr<void>(), &stream), after);
  std::string text;
  while (const auto piece = body->next(kHere)) text += *piece;
  return text;
}

constexpr const char* kEnd = "event: end\ndata: {}\n\n";

TEST(EventStream, TellsAllAndThatItIsAll) {
  EventStream stream;
  stream.add("log", R"({"line":"a"})", false);
  stream.add("state", "{}", true);
  EXPECT_EQ(toldBy(stream), std::string("id: 1\nevent: log\ndata: {\"line\":\"a\"}\n\n") +
                                "id: 2\nevent: state\ndata: {}\n\n" + kEnd);
}

TEST(EventStream, OfWhatStandsTheLastIsKept) {
  EventStream stream;
  for (const char* share : {"1", "2", "3"}) {
    stream.add("progress", share, true);
    stream.add("log", share, false);
  }
  const std::string text = toldBy(stream);
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("progress\ndata: 2")));
  EXPECT_THAT(text, testing::HasSubstr("progress\ndata: 3"));
  EXPECT_THAT(text, testing::HasSubstr("log\ndata: 1"));
}

TEST(EventStream, AClientThatComesAgainIsToldTheRest) {
  EventStream stream;
  for (const char* line : {"1", "2", "3"}) stream.add("log", line, false);
  EXPECT_EQ(toldBy(stream, 2), std::string("id: 3\nevent: log\ndata: 3\n\n") + kEnd);
  EXPECT_EQ(toldBy(stream, 99), kEnd);
}

TEST(EventStream, KeepsABoundedNumberOfLines) {
  EventStream stream;
  stream.add("state", "first", true);
  for (std::size_t i = 0; i < 3 * EventStream::kMostKept; ++i) stream.add("log", std::to_string(i), false);
  const std::string text = toldBy(stream);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'),
            static_cast<std::ptrdiff_t>(4 * EventStream::kMostKept + 3));
  EXPECT_THAT(text, testing::HasSubstr("data: first\n"));
}

TEST(EventStream, EndsWhenNobodyListens) {
  const auto stream = std::make_shared<EventStream>();
  EXPECT_EQ(eventBody(stream, 0)->next([] { return true; }), std::nullopt);
}

}  // namespace
}  // namespace kerfbench::serve
