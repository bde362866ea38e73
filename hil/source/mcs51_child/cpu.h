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

  /// `code` has at most the size of the part's code memory.
  void load(const std::vector<std::uint8_t>& code);
  /// After a reset the registers have their values, and the RAM keeps what it held.
  void reset();

  /// Carries out instructions, the first at `now`, until one ends at `horizon` or later; at least one.
  /// Returns its end. @pre Nothing outside of the processor happens before `horizon`, but for what the
  /// instructions bring about, and that is announced by attend().
  Tick run(Tick now, Tick horizon);
  /// run() comes back from the first instruction that ends at `tick` or later; 0: from the one under way.
  void attend(Tick tick) { horizon_ = tick < horizon_ ? tick : horizon_; }
  /// The end of the instruction under way.
  [[nodiscard]] Tick ends() const { return ends_; }
  void setEnd(Tick tick) { ends_ = tick; }
  /// When the operands of the instruction under way have been read: the end of its first machine cycle.
  [[nodiscard]] Tick fetched() const { return ends_ - clocks_[code_[began_at_]] + part_.cycle(); }
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
  // The program counter while an instruction is carried out, so that it is kept in a register.
  using Pc = std::uint32_t;
  std::uint8_t operand(Pc& pc) { return code_[pc++]; }
  std::uint16_t wordOperand(Pc& pc) {
    const unsigned high = operand(pc);
    return static_cast<std::uint16_t>(high << 8U | operand(pc));
  }

  // Memory.
  std::uint8_t readDirect(std::uint8_t address, bool is_latch = false) {
    return address < 0x80 ? iram_[address] : readSfr(address, is_latch);
  }
  void writeDirect(std::uint8_t address, std::uint8_t value) {
    if (address < 0x80) {
      iram_[address] = value;
    } else {
      writeSfr(address, value);
    }
  }
  std::uint8_t readSfr(std::uint8_t address, bool is_latch);
  void writeSfr(std::uint8_t address, std::uint8_t value);
  void writeSfrBit(std::uint8_t address, std::uint8_t mask, bool on);
  void selectBank() { bank_ = sfrs_[kPsw] & kBank; }
  std::uint8_t& indirect(std::uint8_t address) {
    if (address >= iram_bytes_) [[unlikely]]
      setFault("an access to internal RAM beyond its end");
    return iram_[address];
  }
  std::uint8_t& registerOf(std::uint8_t opcode) { return iram_[bank_ | (opcode & 7U)]; }
  /// The operand of columns 6 to F: the byte that R0 or R1 points at, or a register.
  std::uint8_t& registerOrIndirect(std::uint8_t opcode) {
    return (opcode & 8U) != 0 ? registerOf(opcode) : indirect(registerOf(opcode & 1U));
  }
  bool readBit(std::uint8_t bit, bool is_latch = false) {
    const auto address = static_cast<std::uint8_t>(bit < 0x80 ? 0x20 + (bit >> 3U) : bit & 0xF8U);
    return (readDirect(address, is_latch) >> (bit & 7U) & 1U) != 0;
  }
  void writeBit(std::uint8_t bit, bool on) {
    const auto mask = static_cast<std::uint8_t>(1U << (bit & 7U));
    if (bit >= 0x80) {
      writeSfrBit(bit & 0xF8U, mask, on);
      return;
    }
    auto& byte = iram_[0x20U + (bit >> 3U)];
    byte = static_cast<std::uint8_t>(on ? byte | mask : byte & ~mask);
  }
  std::uint8_t readXram(std::uint16_t address) {
    if (address < xram_.size()) [[likely]]
      return xram_[address];
    setFault("MOVX reaches beyond the external RAM");
    return 0xFF;
  }
  void writeXram(std::uint16_t address, std::uint8_t value) {
    if (address < xram_.size()) [[likely]] {
      xram_[address] = value;
    } else {
      setFault("MOVX reaches beyond the external RAM");
    }
  }
  void push(std::uint8_t value) {
    auto& sp = sfrs_[kSp];
    sp = static_cast<std::uint8_t>(sp + 1);
    if (sp == 0 || sp >= iram_bytes_) [[unlikely]]
      setFault("the stack grew beyond the internal RAM");
    iram_[sp] = value;
  }
  std::uint8_t pop() {
    auto& sp = sfrs_[kSp];
    const std::uint8_t value = iram_[sp];
    if (sp == 0) [[unlikely]]
      setFault("more was taken from the stack than was put there");
    sp = static_cast<std::uint8_t>(sp - 1);
    return value;
  }

  // Registers.
  std::uint8_t& acc() { return sfrs_[kAcc]; }
  std::uint8_t& bRegister() { return sfrs_[kB]; }
  [[nodiscard]] bool carry() const { return (sfrs_[kPsw] & kCarry) != 0; }
  void setCarry(bool on) { sfrs_.set(kPsw, kCarry, on); }
  /// Carry, auxiliary carry and overflow, at their places in PSW.
  void setFlags(unsigned flags) {
    constexpr unsigned kOthers = 0xFFU & ~unsigned{kCarry | kAuxiliaryCarry | kOverflow};
    sfrs_[kPsw] = static_cast<std::uint8_t>((sfrs_[kPsw] & kOthers) | flags);
  }
  [[nodiscard]] std::uint16_t dptr() const {
    const bool second = usesSecondDptr();
    return static_cast<std::uint16_t>(sfrs_[second ? kDp1h : kDph] << 8 | sfrs_[second ? kDp1l : kDpl]);
  }
  void setDptr(std::uint16_t value) {
    const bool second = usesSecondDptr();
    sfrs_[second ? kDp1h : kDph] = static_cast<std::uint8_t>(value >> 8U);
    sfrs_[second ? kDp1l : kDpl] = static_cast<std::uint8_t>(value);
  }
  [[nodiscard]] bool usesSecondDptr() const { return part_.has_second_dptr && (sfrs_[kAuxr1] & 1U) != 0; }

  // Instructions, each with its opcode as a parameter of its template: see instructions.h and jumps.h.
  template <unsigned kOpcode>
  static Pc carryOut(Cpu& cpu, Pc pc);
  template <unsigned kOpcode>
  void execute(Pc& pc);
  template <unsigned kOpcode>
  std::uint8_t source(Pc& pc);
  template <unsigned kOpcode>
  void executeArithmetic(Pc& pc);
  template <unsigned kOpcode>
  void executeMove(Pc& pc);
  template <unsigned kOpcode>
  void executeExchange(Pc& pc);
  template <unsigned kOpcode>
  void executeDecrement(Pc& pc);
  template <unsigned kOpcode>
  void executeAccumulator();
  template <unsigned kOpcode>
  void executeLogicOnDirect(Pc& pc);
  template <unsigned kOpcode>
  void executeBit(Pc& pc);
  template <unsigned kOpcode>
  void executeBitJump(Pc& pc);
  template <unsigned kOpcode>
  void executeJump(Pc& pc);
  template <unsigned kOpcode>
  void executeCompare(Pc& pc);
  template <unsigned kOpcode>
  void executeMemory(Pc& pc);
  template <unsigned kOpcode>
  void executeOther(Pc& pc);
  template <unsigned kOpcode>
  void step(Pc& pc);
  void add(std::uint8_t value, bool carry_in);
  void subtract(std::uint8_t value);
  void multiply();
  void divide();
  void adjustDecimal();
  void ret(Pc& pc);
  void pushPc(Pc& pc, std::uint16_t target);
  void jumpIf(Pc& pc, bool is_taken);
  void waitIf(Pc& pc, bool is_taken);
  void compare(Pc& pc, std::uint8_t left, std::uint8_t right);
  [[nodiscard]] std::uint64_t wholeTurns() const;
  void passOver(std::uint64_t turns);

  using Instruction = Pc (*)(Cpu&, Pc);
  template <std::size_t... kOpcodes>
  static constexpr std::array<Instruction, 256> table(std::index_sequence<kOpcodes...> /*opcodes*/) {
    return {&carryOut<kOpcodes>...};
  }

  const Part& part_;
  const ClockTable& clocks_;
  Sfrs& sfrs_;
  Peripherals& peripherals_;
  std::uint32_t iram_bytes_;
  std::uint32_t bank_{};  // Bank of PSW, which each addition writes anew.
  std::uint32_t pc_{};
  std::uint32_t began_at_{};        // Address of the instruction under way.
  Tick ends_{};                     // End of the instruction under way.
  Tick passed_{};                   // What is to be added to it.
  Tick horizon_{};                  // See run().
  std::vector<std::uint8_t> code_;  // All that sixteen bits reach, and the operands of the last instruction.
  std::vector<std::uint8_t> xram_;
  std::array<std::uint8_t, 256> iram_{};
  bool has_returned_{};
  std::string fault_;
};

}  // namespace kerfbench::mcs51_child
