// SPDX-License-Identifier: Apache-2.0
#include "hil/base/input_file.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/base/piece_reader.h"
#include "hil/base/yaml_reader.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::base {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string refusalOf(const fs::path& path, std::uint64_t most_bytes = 100) {
  const InputContent content = readInput(path, most_bytes);
  EXPECT_EQ(content.bytes.has_value(), content.refusal.empty());
  return content.refusal;
}

TEST(InputFile, IsReadWhole) {
  const TempFolder folder;
  const std::string content = std::string("a\0\r\n", 4) + std::string(200'000, 'x');
  const InputContent read = readInput(folder.write("all", content), content.size());
  EXPECT_EQ(read.bytes, content);
  EXPECT_EQ(read.error, 0);
  EXPECT_EQ(readInput(folder.write("empty", ""), 0).bytes, "");
}

// A FIFO has no writer here: who opens it as a file is opened waits for ever.
TEST(InputFile, RefusesWhatIsNoRegularFileByWhatItIs) {
  const TempFolder folder;
  const fs::path fifo = folder.path() / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(refusalOf(fifo), "is a pipe (FIFO), no regular file");
  EXPECT_EQ(refusalOf(folder.path()), "is a folder, no regular file");
  EXPECT_EQ(refusalOf("/dev/zero"), "is a device, no regular file");
  EXPECT_EQ(refusalOf("/dev/null"), "is a device, no regular file");

  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = (folder.path() / "socket").string();
  ASSERT_LT(name.size(), sizeof address.sun_path);
  std::ranges::copy(name, static_cast<char*>(address.sun_path));
  const UniqueFd socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ASSERT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(refusalOf(name), "is a socket, no regular file");
}

TEST(InputFile, TellsWhatTheSystemSays) {
  const TempFolder folder;
  EXPECT_EQ(refusalOf(folder.path() / "none"), "no such file");
  EXPECT_EQ(readInput(folder.path() / "none", 1).error, ENOENT);
  EXPECT_THAT(refusalOf(folder.write("file", "") / "below"), HasSubstr("cannot be opened: Not a directory"));
}

TEST(InputFile, RefusesMoreThanItsReaderTakesBeforeItReads) {
  const TempFolder folder;
  const fs::path file = folder.write("file", std::string(100, 'x'));
  EXPECT_EQ(refusalOf(file, 100), "");
  EXPECT_EQ(refusalOf(file, 99), "has 100 bytes, and at most 99 are read");
  // A sparse file counts as what it seems to be. It has no block on the disk: nothing of it was read.
  fs::resize_file(file, std::uintmax_t{1} << 40U);
  EXPECT_EQ(refusalOf(file), "has 1099511627776 bytes, and at most 100 are read");
}

// Files of the kernel have no size until they are read.
TEST(InputFile, HoldsToItsLimitWhatHasNoSize) {
  EXPECT_GT(readInput("/proc/self/status", 1U << 20U).bytes.value().size(), 100U);
  EXPECT_EQ(refusalOf("/proc/self/status", 100), "has more than the 100 bytes that are read");
}

TEST(InputFile, NamesTheFileInWhatItThrows) {
  const TempFolder folder;
  try {
    (void)inputContent(folder.path(), 1);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()), folder.path().string() + ": is a folder, no regular file");
  }
}

std::string faultsOfYaml(const fs::path& path) {
  try {
    auto file = YamlReader::openFile(path);
    (void)file.number("speed", {.fallback = 1.0});
    file.finish();
  } catch (const ConfigError& e) {
    return e.what();
  }
  return {};
}

// Who may write a scenario, as at the window, may not have read the file that it names.
TEST(InputFile, WhatAnotherFileNamesIsNotQuotedUnlessItIsOfItsKind) {
  const TempFolder folder;
  const std::string secret = "root: hunter2\npassword: hunter3\n";
  (void)folder.write("shadow", secret);
  (void)folder.write("wireless.yaml", secret);
  const auto extending = [&](const std::string& other) {
    return faultsOfYaml(folder.write("own.yaml", "extends: " + other + "\nspeed: 2\n"));
  };
  EXPECT_THAT(extending("shadow"), AllOf(HasSubstr("'shadow' is no .yaml file"), Not(HasSubstr("hunter"))));
  EXPECT_THAT(extending("../../../../../etc/shadow"), HasSubstr("is no .yaml file"));
  EXPECT_THAT(extending("wireless.yaml"), AllOf(HasSubstr("wireless.yaml:1: none of its keys is known"),
                                                Not(HasSubstr("hunter")), Not(HasSubstr("password"))));
  (void)folder.write("near.yaml", "speed: 3\nspeeed: 4\n");
  EXPECT_THAT(extending("near.yaml"), HasSubstr("near.yaml:2: speeed: unknown key"));
}

}  // namespace
}  // namespace kerfbench::base
