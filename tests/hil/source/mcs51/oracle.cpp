// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/source/mcs51/oracle.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "hil/source/mcs51_child/chip.h"

namespace kerfbench::mcs51_child {
namespace {

constexpr std::size_t kWholeXram = 0x10000;

/// A file that goes with the program. A whole suite of tests may use it, unlike base::TempFolder.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& text) {
    const int descriptor = ::mkstemps(path_, 4);
    if (descriptor < 0 ||
        ::write(descriptor, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
      throw std::runtime_error("no file for s51 can be written");
    }
    ::close(descriptor);
  }
  ~ScratchFile() { ::unlink(path_); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  [[nodiscard]] std::string path() const { return path_; }

 private:
  char path_[40] = "/tmp/kerfbench-s51-XXXXXX.ihx";
};

unsigned hexByte(const std::string& line, std::size_t at) {
  return static_cast<unsigned>(std::stoul(line.substr(at, 2), nullptr, 16));
}

/// Reads the Intel HEX that a dump prints into bytes.
void readDump(std::istream& in, std::uint8_t* bytes, std::size_t size) {
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] != ':') continue;
    const unsigned count = hexByte(line, 1);
    if (line.substr(7, 2) == "01") return;
    const std::size_t address = hexByte(line, 3) * 256U + hexByte(line, 5);
    for (unsigned i = 0; i < count; ++i) {
      if (address + i < size) bytes[address + i] = static_cast<std::uint8_t>(hexByte(line, 9 + 2 * i));
    }
  }
  throw std::runtime_error("s51 did not dump what it should");
}

}  // namespace

std::string s51Program() {
  for (const char* path : {"/usr/bin/s51", "/usr/local/bin/s51"}) {
    if (std::FILE* file = std::fopen(path, "r")) {
      (void)std::fclose(file);
      return path;
    }
  }
  return {};
}

std::string intelHex(const std::vector<std::uint8_t>& code) {
  std::string text;
  char digits[8];
  for (std::size_t at = 0; at < code.size(); at += 32) {
    const std::size_t count = std::min<std::size_t>(32, code.size() - at);
    unsigned sum = static_cast<unsigned>(count + (at >> 8U) + at);
    std::snprintf(digits, sizeof digits, "%02X", static_cast<unsigned>(count));
    text += ":" + std::string(digits);
    std::snprintf(digits, sizeof digits, "%04X", static_cast<unsigned>(at));
    text += digits + std::string("00");
    for (std::size_t i = at; i < at + count; ++i) {
      sum += code[i];
      std::snprintf(digits, sizeof digits, "%02X", code[i]);
      text += digits;
    }
    std::snprintf(digits, sizeof digits, "%02X\n", (0x100U - (sum & 0xFFU)) & 0xFFU);
    text += digits;
  }
  return text + ":00000001FF\n";
}

std::string askS51(const std::string& options, const std::string& commands) {
  const ScratchFile script(commands);
  // A program that never comes to its end would otherwise run for ever.
  const std::string line =
      "timeout 60 " + s51Program() + " " + options + " -q -b < '" + script.path() + "' 2>&1";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(line.c_str(), "r"), ::pclose);
  if (pipe == nullptr) throw std::runtime_error("s51 does not start");
  std::string text;
  char block[65536];
  for (std::size_t got = 0; (got = std::fread(block, 1, sizeof block, pipe.get())) > 0;)
    text.append(block, got);
  return text;
}

Memories runS51(const std::vector<std::uint8_t>& code, std::uint16_t stop) {
  const ScratchFile image(intelHex(code));
  const std::string said = askS51("-t 32", "fill xram 0 0xffff 0\nfill iram 0 0xff 0\nfile \"" +
                                               image.path() + "\"\nrun 0 " + std::to_string(stop) +
                                               "\nstate\ndump /i iram 0 0xff\ndump /i sfr 0x80 0xff\n"
                                               "dump /i xram 0 0xffff\nquit\n");
  Memories result;
  result.xram.resize(kWholeXram);
  std::istringstream in(said);
  const std::string mark = "Total time since last reset=";
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(mark)) continue;
    result.clocks = std::stoull(line.substr(line.find('(') + 1));
    break;
  }
  readDump(in, result.iram.data(), result.iram.size());
  std::array<std::uint8_t, 256> sfr{};
  readDump(in, sfr.data(), sfr.size());
  std::copy(sfr.begin() + 128, sfr.end(), result.sfr.begin());
  readDump(in, result.xram.data(), result.xram.size());
  return result;
}

Memories runOurs(const std::vector<std::uint8_t>& code, std::uint16_t stop) {
  std::vector<std::uint8_t> whole = code;
  whole.resize(kWholeXram, 0);
  Chip chip(partCalled("80c32"), whole, 1U << 24U);
  constexpr Tick kLongest = 2'000'000'000;
  chip.settle();
  while (chip.cpu().pc() != stop && chip.now() < kLongest && chip.fault().empty()) {
    chip.execute(chip.now() + 1);
    while (chip.settle()) {
    }
  }
  if (!chip.fault().empty()) throw std::runtime_error(chip.fault());
  if (chip.now() >= kLongest) throw std::runtime_error("the program does not come to its end");
  Memories result;
  result.iram = chip.cpu().iram();
  for (unsigned i = 0; i < 128; ++i) result.sfr[i] = chip.peekSfr(static_cast<std::uint8_t>(0x80U + i));
  result.sfr[kPsw & 0x7FU] = chip.cpu().psw();
  for (const std::uint8_t plain : {kAcc, kB, kSp, kDpl, kDph}) result.sfr[plain & 0x7FU] = chip.sfrs()[plain];
  result.xram = chip.cpu().xram();
  result.clocks = chip.now();
  return result;
}

}  // namespace kerfbench::mcs51_child
