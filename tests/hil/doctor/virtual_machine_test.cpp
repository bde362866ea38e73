// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/virtual_machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::doctor {
namespace {

class VirtualMachineTest : public testing::Test {
 protected:
  void put(const std::filesystem::path& file, const std::string& text) {
    std::filesystem::create_directories((temp.path() / file).parent_path());
    std::ofstream(temp.path() / file, std::ios::binary) << text;
  }
  std::string sign() const { return virtualMachineSign(temp.path()); }
  const base::TempFolder temp;
};

TEST_F(VirtualMachineTest, AMachineShowsNothing) {
  EXPECT_EQ(sign(), "");
  put("sys/class/dmi/id/sys_vendor", "Dell Inc.\n");
  put("proc/cpuinfo", "processor\t: 0\nmodel name\t: hypervisor\nflags\t\t: fpu sse hypervisor_not\n");
  EXPECT_EQ(sign(), "");
}

TEST_F(VirtualMachineTest, EachSignOfOneIsFound) {
  put("proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu hypervisor sse\n");
  EXPECT_EQ(sign(), "the processor has the flag 'hypervisor'");
  put("proc/device-tree/hypervisor/compatible", std::string("linux,kvm\0more\0", 15));
  EXPECT_EQ(sign(), "the device tree names the hypervisor 'linux,kvm'");
  put("sys/hypervisor/type", "xen\n");
  EXPECT_EQ(sign(), "the kernel names the hypervisor 'xen'");
  put("sys/class/dmi/id/sys_vendor", "QEMU\n");
  EXPECT_EQ(sign(), "its maker is 'QEMU'");
}

}  // namespace
}  // namespace kerfbench::doctor
