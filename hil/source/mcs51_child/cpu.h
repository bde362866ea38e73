// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hil/source/mcs51_child/part.h"
#include "hil/source/mcs51_child/sfr.h"

namespace kerfbench::mcs51_child {

/// Special function registers that are more than memory.
class Peripherals {
 public:
  virtual ~Peripherals() = default;
  /// A register as an instruction reads it. Of a port, `is_latch` asks for the latch, as read-modify-write
  /// instructions do, in place of the pins.
  virtual std::uint8_t readSfr(std::uint8_t address, bool is_latch) = 0;
  virtual void writeSfr(std::uint8_t address, std::uint8_t value) = 0;
  /// A bit of a register, as bit instructions write it: a flag beside it that hardware sets meanwhile stays.
  virtual void writeSfrBit(std::uint8_t address, std::uint8_t mask, bool on) = 0;
};

/// Registers, memories and the 255 instructions of an MCS-51 (Intel 1994, chapter 2).
///
/// An instruction that cannot go on as on silicon sets fault(), and is then of no effect that anybody should
/// look at.
class Cpu {
 public:
  Cpu(const Part& part, Sfrs& sfrs, Peripherals& peripherals);

  /// `code` has the size of the part's code memory.
  void load(std::vector<std::uint8_t> code) { code_ = std::move(code); }
  /// After a reset the registers have their values, and the RAM keeps what it held.
  void reset();

  /// The opcode at the program counter; 0xA5 with a fault() where no memory is.
  std::uint8_t fetchOpcode() {
    began_at_ = pc_;
    if (pc_ < code_.size()) return code_[pc_++];
    setFault("the program counter left the code memory");
    return 0xA5;
  }
  /// Carries out the instruction whose opcode has just been fetched.
  void execute(std::uint8_t opcode);
  /// Pushes the program counter and goes to `vector`.
  void call(std::uint16_t vector);
  /// Whether the last instruction was RETI; forgets it.
  bool takeReturnFromInterrupt() { return std::exchange(has_returned_, false); }
  [[nodiscard]] bool hasReturned() const { return has_returned_; }

  [[nodiscard]] std::uint32_t pc() const { return pc_; }
  void setPc(std::uint16_t pc) { pc_ = pc; }
  /// Why the firmware cannot go on; empty while it can.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  /// The instruction under way cannot go on as on silicon. The first word counts.
  void setFault(const std::string& what);
  [[nodiscard]] std::array<std::uint8_t, 256>& iram() { return iram_; }
  [[nodiscard]] std::vector<std::uint8_t>& xram() { return xram_; }
  /// PSW with the parity of the accumulator.
  [[nodiscard]] std::uint8_t psw() const;

 private:
  [[nodiscard]] std::uint8_t code(std::uint32_t address) const {
    return address < code_.size() ? code_[address] : 0xFF;
  }
  std::uint8_t operand() { return code(pc_++); }
  std::uint16_t wordOperand();

  // Memory.
  std::uint8_t readDirect(std::uint8_t address, bool is_latch = false);
  void writeDirect(std::uint8_t address, std::uint8_t value);
  std::uint8_t& indirect(std::uint8_t address) {
    if (address >= part_.iram_bytes) setFault("an access to internal RAM beyond its end");
    return iram_[address];
  }
  std::uint8_t& registerOf(std::uint8_t opcode) { return iram_[(sfrs_[kPsw] & kBank) | (opcode & 7U)]; }
  /// The operand of columns 6 to F: the byte that R0 or R1 points at, or a register.
  std::uint8_t& registerOrIndirect(std::uint8_t opcode) {
    return (opcode & 8U) != 0 ? registerOf(opcode) : indirect(registerOf(opcode & 1U));
  }
  std::uint8_t source(std::uint8_t opcode);
  bool readBit(std::uint8_t bit, bool is_latch = false);
  void writeBit(std::uint8_t bit, bool on);
  std::uint8_t readXram(std::uint16_t address);
  void writeXram(std::uint16_t address, std::uint8_t value);
  void push(std::uint8_t value);
  std::uint8_t pop();

  // Registers.
  std::uint8_t& acc() { return sfrs_[kAcc]; }
  std::uint8_t& bRegister() { return sfrs_[kB]; }
  [[nodiscard]] bool carry() const { return (sfrs_[kPsw] & kCarry) != 0; }
  void setCarry(bool on) { sfrs_.set(kPsw, kCarry, on); }
  void setFlags(bool carry_out, bool auxiliary, bool overflow) {
    const unsigned others = sfrs_[kPsw] & ~unsigned{kCarry | kAuxiliaryCarry | kOverflow};
    sfrs_[kPsw] = static_cast<std::uint8_t>(others | (carry_out ? kCarry : 0U) |
                                            (auxiliary ? kAuxiliaryCarry : 0U) | (overflow ? kOverflow : 0U));
  }
  [[nodiscard]] std::uint16_t dptr() const;
  void setDptr(std::uint16_t value);
  [[nodiscard]] bool usesSecondDptr() const { return part_.has_second_dptr && (sfrs_[kAuxr1] & 1U) != 0; }

  // Groups of instructions.
  void executeArithmetic(std::uint8_t opcode);
  void executeMove(std::uint8_t opcode);
  void executeExchange(std::uint8_t opcode);
  void executeAccumulator(std::uint8_t opcode);
  void executeLogicOnDirect(std::uint8_t opcode);
  void executeBit(std::uint8_t opcode);
  void executeBitJump(std::uint8_t opcode);
  void executeJump(std::uint8_t opcode);
  void executeCompare(std::uint8_t opcode);
  void executeMemory(std::uint8_t opcode);
  void executeOther(std::uint8_t opcode);
  void executeOnMemoryOrBits(std::uint8_t opcode);
  void step(std::uint8_t opcode, std::uint8_t by);
  void add(std::uint8_t value, bool carry_in);
  void subtract(std::uint8_t value);
  void multiply();
  void divide();
  void adjustDecimal();
  void jumpIf(bool is_taken);
  void compare(std::uint8_t left, std::uint8_t right);

  const Part& part_;
  Sfrs& sfrs_;
  Peripherals& peripherals_;
  std::vector<std::uint8_t> code_;
  std::vector<std::uint8_t> xram_;
  std::array<std::uint8_t, 256> iram_{};
  std::uint32_t pc_{};
  std::uint32_t began_at_{};  // Address of the instruction under way.
  bool has_returned_{};
  std::string fault_;
};

}  // namespace kerfbench::mcs51_child
