# SPDX-License-Identifier: Apache-2.0
# Builds one AVR release: OUT.elf and OUT.hex. The build and the test that builds twice use the same.
#
#     cmake -DGCC=avr-gcc -DOBJCOPY=avr-objcopy -DSOURCE=ROOT -DVERSION_HEADER=kb_version.h "-DSOURCES=core/belt.c;…" \
#       "-DDEFINES=KB_…" -DOUT=firmware/controller-avr -P build_avr.cmake
#
# -O3: with all axes, a 20 kHz encoder and a wire never at rest, -O2 works but fails at 23 kHz, -O3 bears 26 kHz.
set(dir ${SOURCE}/firmware_under_test/controller)
list(TRANSFORM SOURCES PREPEND ${dir}/)
list(TRANSFORM DEFINES PREPEND -D)
execute_process(
  COMMAND ${GCC} -mmcu=atmega2560 -DF_CPU=16000000UL -std=gnu11 -O3 -flto -fshort-enums -Wall -Wextra -Wconversion
    -Wshadow -Werror ${DEFINES} -include ${VERSION_HEADER} -I${SOURCE} -I${dir}/avr -I${dir}/core ${SOURCES} -o ${OUT}.elf
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${OBJCOPY} -O ihex -R .eeprom ${OUT}.elf ${OUT}.hex COMMAND_ERROR_IS_FATAL ANY)
