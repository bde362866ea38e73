// SPDX-License-Identifier: GPL-2.0-or-later
// Unicorn, a library made of QEMU, as the other opinion about what instructions do.
#include <unicorn/unicorn.h>

#include <stdexcept>

#include "tests/hil/source/cortex_m/oracle/cores.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::array kRegisters{UC_ARM_REG_R0,  UC_ARM_REG_R1,  UC_ARM_REG_R2,  UC_ARM_REG_R3,
                                UC_ARM_REG_R4,  UC_ARM_REG_R5,  UC_ARM_REG_R6,  UC_ARM_REG_R7,
                                UC_ARM_REG_R8,  UC_ARM_REG_R9,  UC_ARM_REG_R10, UC_ARM_REG_R11,
                                UC_ARM_REG_R12, UC_ARM_REG_R13, UC_ARM_REG_R14};
constexpr std::uint32_t kThumb = 1U << 24, kFlags = 0xF8000000;
constexpr std::size_t kMostInstructions = 20'000;

void check(uc_err error) {
  if (error != UC_ERR_OK) throw std::runtime_error(std::string("Unicorn: ") + uc_strerror(error));
}

class UnicornCore final : public TestedCore {
 public:
  explicit UnicornCore(std::vector<std::uint8_t>& code) : sram_(kDataBytes) {
    const int mode = UC_MODE_THUMB | UC_MODE_MCLASS;
    check(uc_open(UC_ARCH_ARM, static_cast<uc_mode>(mode), &engine_));
    check(uc_ctl_set_cpu_model(engine_, UC_CPU_ARM_CORTEX_M3));
    check(uc_mem_map_ptr(engine_, kCodeBase, code.size(), UC_PROT_READ | UC_PROT_EXEC, code.data()));
    check(uc_mem_map_ptr(engine_, kDataBase, sram_.size(), UC_PROT_ALL, sram_.data()));
  }
  ~UnicornCore() override { uc_close(engine_); }
  UnicornCore(const UnicornCore&) = delete;
  UnicornCore& operator=(const UnicornCore&) = delete;

  std::string run(std::uint32_t begin, std::uint32_t end, MachineState& state) override {
    std::copy(state.sram.begin(), state.sram.end(), sram_.begin());
    for (std::size_t i = 0; i < state.r.size(); ++i) uc_reg_write(engine_, kRegisters[i], &state.r[i]);
    std::uint32_t status = state.flags | kThumb;
    uc_reg_write(engine_, UC_ARM_REG_XPSR, &status);
    const uc_err error = uc_emu_start(engine_, begin | 1U, end, 0, kMostInstructions);
    for (std::size_t i = 0; i < state.r.size(); ++i) uc_reg_read(engine_, kRegisters[i], &state.r[i]);
    std::uint32_t pc = 0;
    uc_reg_read(engine_, UC_ARM_REG_PC, &pc);
    uc_reg_read(engine_, UC_ARM_REG_XPSR, &status);
    state.flags = status & kFlags;
    std::copy(sram_.begin(), sram_.end(), state.sram.begin());
    if (error == UC_ERR_OK && pc == end) return {};
    return std::string("Unicorn stops: ") + uc_strerror(error) + " at " + std::to_string(pc - kCodeBase);
  }

 private:
  uc_engine* engine_{};
  std::vector<std::uint8_t> sram_;
};

}  // namespace

std::unique_ptr<TestedCore> makeUnicorn(std::vector<std::uint8_t>& code) {
  return std::make_unique<UnicornCore>(code);
}

}  // namespace kerfbench::cortex_m_child
