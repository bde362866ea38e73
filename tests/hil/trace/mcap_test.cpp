// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/mcap_records.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/trace/mcap_reader.h"
#include "hil/trace/mcap_writer.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::trace {
namespace {

std::string hex(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return text;
}

/// Kinds of the records of a file, in their order.
std::vector<McapOp> kindsIn(const std::filesystem::path& path) {
  McapReader reader(path);
  std::vector<McapOp> kinds;
  while (const auto record = reader.next()) kinds.push_back(record->op);
  EXPECT_EQ(reader.cutOff_bytes(), 0U);
  return kinds;
}

TEST(McapRecords, HaveTheBytesThatTheFormatAsksFor) {
  McapBytes out;
  out.record(McapOp::kHeader, [&] {
    out.text("ab");
    out.u16(0x1234);
    out.u32(0x01020304);
    out.u64(0x1122334455667788);
    out.textMap({{"k", "v"}});
  });
  EXPECT_EQ(hex(out.bytes()),
            "01"                // header
            "2200000000000000"  // 34 bytes
            "02000000"
            "6162"  // "ab"
            "3412"
            "04030201"
            "8877665544332211"
            "0a000000"
            "01000000"
            "6b"
            "01000000"
            "76");
}

// The check value of CRC-32 in every catalogue of CRCs.
TEST(McapRecords, HaveTheCrcOfTheFormat) {
  EXPECT_EQ(mcapCrc("123456789"), 0xCBF43926U);
  EXPECT_EQ(mcapCrc(""), 0U);
}

TEST(McapRecords, ACursorGivesBackWhatWasWrittenAndNoMore) {
  McapBytes out;
  out.u8(7);
  out.u64(1ULL << 63U);
  out.textMap({{"a", "1"}, {"b", ""}});
  McapCursor cursor(out.bytes());
  EXPECT_EQ(cursor.u8(), 7);
  EXPECT_EQ(cursor.u64(), 1ULL << 63U);
  EXPECT_EQ(cursor.textMap(), (std::map<std::string, std::string>{{"a", "1"}, {"b", ""}}));
  EXPECT_TRUE(cursor.atEnd());
  EXPECT_THROW(cursor.u8(), McapError);
}

class McapFile : public testing::Test {
 protected:
  /// A file with two groups that grow side by side, metadata and an attachment.
  [[nodiscard]] std::filesystem::path written() const {
    const auto path = temp_.path() / "a.mcap";
    McapWriter writer(path, "test");
    writer.addMetadata("run", {{"seed", "1"}});
    writer.addSchema({"S", "{}"});
    const std::uint16_t first = writer.addChannel({"/first", 1});
    const std::uint16_t second = writer.addChannel({"/second", 1});
    McapChunk a, b;
    for (std::uint64_t i = 0; i < 3; ++i) {
      a.add(first, 100 * i, fmt::format("{{\"a\":{}}}", i));
      b.add(second, 100 * i + 50, fmt::format("{{\"b\":{}}}", i));
    }
    writer.write(a);
    writer.write(b);
    EXPECT_TRUE(a.empty());
    a.add(first, 300, "{}");
    writer.write(a);
    writer.write(b);  // Nothing is in it.
    writer.addAttachment("job.gcode", "text/plain", "G00", 5);
    writer.close();
    return path;
  }
  const base::TempFolder temp_;
};

TEST_F(McapFile, HasItsRecordsInTheOrderOfTheFormat) {
  using enum McapOp;
  EXPECT_THAT(
      kindsIn(written()),
      testing::ElementsAre(kHeader, kMetadata, kSchema, kChannel, kChannel, kChunk, kMessageIndex, kChunk,
                           kMessageIndex, kChunk, kMessageIndex, kAttachment, kDataEnd, kSchema, kChannel,
                           kChannel, kStatistics, kChunkIndex, kChunkIndex, kChunkIndex, kAttachmentIndex,
                           kMetadataIndex, kSummaryOffset, kSummaryOffset, kSummaryOffset, kSummaryOffset,
                           kSummaryOffset, kSummaryOffset, kFooter));
}

TEST_F(McapFile, BeginsAndEndsWithTheMagicAndHasTheSumOfItsSummary) {
  const std::string bytes = base::contentOf(written());
  EXPECT_EQ(hex(bytes.substr(0, 8)), "894d434150300d0a");
  EXPECT_TRUE(bytes.ends_with(kMcapMagic));
  const std::size_t footer = bytes.size() - 8 - 20;
  McapCursor cursor(std::string_view(bytes).substr(footer));
  const std::uint64_t summary = cursor.u64();
  cursor.u64();
  EXPECT_EQ(cursor.u32(), mcapCrc(std::string_view(bytes).substr(summary, footer + 16 - summary)));
  EXPECT_EQ(static_cast<McapOp>(bytes[summary]), McapOp::kSchema);
}

TEST_F(McapFile, ItsIndexLeadsToEachMessage) {
  const std::string bytes = base::contentOf(written());
  McapReader reader(temp_.path() / "a.mcap");
  std::vector<std::string> found;
  while (const auto record = reader.next()) {
    if (record->op != McapOp::kChunkIndex) continue;
    McapCursor index(record->content);
    index.u64();
    index.u64();
    const std::uint64_t chunk = index.u64();
    const std::uint64_t length = index.u64();
    const std::string records =
        chunkRecords(std::string_view(bytes).substr(chunk + kRecordHead_bytes, length - kRecordHead_bytes));
    McapCursor offsets(index.text());
    while (!offsets.atEnd()) {
      offsets.u16();
      McapCursor messages(std::string_view(bytes).substr(offsets.u64() + kRecordHead_bytes));
      messages.u16();
      McapCursor entries(messages.text());
      while (!entries.atEnd()) {
        const std::uint64_t time_ns = entries.u64();
        McapCursor at(std::string_view(records).substr(entries.u64()));
        EXPECT_EQ(static_cast<McapOp>(at.u8()), McapOp::kMessage);
        const McapMessage message = readMcapMessage(at.raw(at.u64()));
        EXPECT_EQ(message.log_time_ns, time_ns);
        found.emplace_back(message.data);
      }
    }
  }
  EXPECT_THAT(found, testing::ElementsAre(R"({"a":0})", R"({"a":1})", R"({"a":2})", R"({"b":0})",
                                          R"({"b":1})", R"({"b":2})", "{}"));
}

TEST_F(McapFile, AChunkWithAWrongByteIsRefusedOrIsTheSame) {
  McapReader reader(written());
  while (const auto record = reader.next()) {
    if (record->op != McapOp::kChunk) continue;
    const std::string good(record->content);
    const std::string records = chunkRecords(good);
    std::size_t refused = 0;
    for (std::size_t i = 0; i < good.size(); ++i) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ 0x11);
      try {
        // Times of first and last message are no part of what the sum is over, and zstd has a bit that nobody
        // uses.
        EXPECT_EQ(chunkRecords(bad), records) << "byte " << i;
      } catch (const McapError&) {
        ++refused;
      }
    }
    EXPECT_GE(refused, good.size() - 20);
    return;
  }
  FAIL() << "no chunk";
}

TEST_F(McapFile, IsTheSameBytesEachTime) {
  const std::string once = base::contentOf(written());
  EXPECT_EQ(base::contentOf(written()), once);
}

TEST_F(McapFile, OnlyWhatBeginsAsMcapIsRead) {
  EXPECT_THROW(McapReader(temp_.write("text", "no MCAP file at all")), McapError);
  EXPECT_THROW(McapReader(temp_.write("short", "\x89MC")), McapError);
  EXPECT_THROW(McapReader(temp_.path() / "none"), std::system_error);
}

// A chunk that claims a terabyte, or half a gigabyte, must not take it.
TEST_F(McapFile, AChunkThatClaimsTooMuchIsRefusedBeforeItTakesMemory) {
  for (const std::uint64_t size : {1ULL << 29U, 1ULL << 40U}) {
    McapBytes out;
    out.u64(0);
    out.u64(0);
    out.u64(size);
    out.u32(0);
    out.text("zstd");
    out.u64(0);
    try {
      chunkRecords(out.bytes());
      ADD_FAILURE() << size;
    } catch (const McapError& refused) {
      EXPECT_EQ(std::string(refused.what()), fmt::format("a chunk of {} bytes", size));
    }
  }
}

TEST_F(McapFile, ADiskThatIsNotThereIsToldWithItsPath) {
  try {
    const McapWriter writer(temp_.path() / "none" / "a.mcap", "test");
    FAIL() << "no error";
  } catch (const std::system_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("none/a.mcap"));
  }
}

}  // namespace
}  // namespace kerfbench::trace
