# SPDX-License-Identifier: Apache-2.0
# Builds one release for the STM32F103: OUT.elf and OUT.hex.
#
#     cmake -DGCC=arm-none-eabi-gcc -DOBJCOPY=arm-none-eabi-objcopy -DSOURCE=ROOT -DVERSION_HEADER=kb_version.h
#       "-DSOURCES=core/belt.c;…" "-DDEFINES=KB_…" -DOUT=firmware/controller-stm32 -P build_stm32.cmake
#
# -fno-tree-loop-distribute-patterns: memcpy() must not be made of calls to memcpy().
set(dir ${SOURCE}/firmware_under_test/controller)
list(TRANSFORM SOURCES PREPEND ${dir}/)
list(TRANSFORM DEFINES PREPEND -D)
execute_process(
  COMMAND ${GCC} -mcpu=cortex-m3 -mthumb -std=gnu11 -O2 -ffreestanding -nostdlib -fno-tree-loop-distribute-patterns -fshort-enums
    -fdata-sections -ffunction-sections -Wl,--gc-sections -Wall -Wextra -Wconversion -Wshadow -Werror -DKB_TARGET_STM32 ${DEFINES}
    -include ${VERSION_HEADER} -I${SOURCE} -I${dir}/stm32 -I${dir}/core -T ${dir}/stm32/link.ld ${SOURCES} -lgcc -o ${OUT}.elf
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${OBJCOPY} -O ihex ${OUT}.elf ${OUT}.hex COMMAND_ERROR_IS_FATAL ANY)
