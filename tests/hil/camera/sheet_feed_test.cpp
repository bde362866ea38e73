// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/sheet_feed.h"

#include <memory>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "twin/sheet/sheet.h"

namespace kerfbench::camera {
namespace {

std::shared_ptr<const twin::Sheet> piece() {
  return std::make_shared<const twin::Sheet>(twin::BoardDescription{});
}

TEST(SheetFeed, HandsOutPiecesInOrderAndThenTheRestForEachUnitThatFollows) {
  SheetFeed feed(2);
  const auto first = piece(), second = piece(), rest = piece();
  feed.add(first);
  feed.add(second);
  feed.end(rest);
  EXPECT_EQ(feed.take(), first);
  EXPECT_EQ(feed.take(), second);
  EXPECT_EQ(feed.take(), rest);
  EXPECT_EQ(feed.take(), rest);
}

TEST(SheetFeed, AMachineThatIsAheadWaitsForTheCamera) {
  SheetFeed feed(1);
  std::weak_ptr<const twin::Sheet> waiting;
  {
    auto only = piece();
    waiting = only;
    feed.add(std::move(only));
  }
  std::thread machine([&] {
    feed.add(piece());
    feed.end(piece());
  });
  EXPECT_TRUE(feed.take());
  EXPECT_TRUE(waiting.expired());  // Nothing is kept of what was taken and dropped.
  EXPECT_TRUE(feed.take());
  machine.join();
}

TEST(SheetFeed, NobodyWaitsForACameraThatHasStopped) {
  SheetFeed feed(1);
  feed.add(piece());
  feed.close();
  feed.add(piece());
  feed.add(piece());
  EXPECT_EQ(feed.take(), nullptr);
}

}  // namespace
}  // namespace kerfbench::camera
