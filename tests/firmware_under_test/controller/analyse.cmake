# SPDX-License-Identifier: Apache-2.0
# Static analysis of the controller's C, for all time bases: GCC's analyser, and cppcheck where there is one. That of the STM32 is read
# by the compiler for it, where there is one.
#
#     cmake -DCC=gcc -DARM_CC=arm-none-eabi-gcc -DCPPCHECK=cppcheck -DSOURCE=ROOT -P analyse.cmake
set(dir ${SOURCE}/firmware_under_test/controller)
file(GLOB sources ${dir}/core/*.c ${dir}/native/*.c)
list(LENGTH sources count)
if(count LESS 7)
  message(FATAL_ERROR "only ${count} sources found below ${dir}")
endif()
foreach(define IN ITEMS KB_TARGET_AVR KB_TARGET_GALVO)
  foreach(source IN LISTS sources)
    execute_process(
      COMMAND ${CC} -fanalyzer -O2 -std=gnu11 -Wall -Wextra -Wconversion -Wshadow -Werror -D${define} -I${SOURCE} -I${dir}/native
        -S -o /dev/null ${source}
      COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  if(CPPCHECK)
    # GCC, the only compiler this is for, shifts negative numbers as everybody expects.
    execute_process(
      COMMAND ${CPPCHECK} --quiet --error-exitcode=1 --enable=warning,performance,portability --std=c11 -D${define} -I${SOURCE}
        -I${dir}/native --suppress=missingIncludeSystem --suppress=shiftNegativeLHS --suppress=shiftNegative ${dir}/core ${dir}/native
      COMMAND_ERROR_IS_FATAL ANY)
  endif()
endforeach()
if(ARM_CC)
  file(GLOB sources ${dir}/core/*.c ${dir}/stm32/*.c)
  foreach(source IN LISTS sources)
    execute_process(
      COMMAND ${ARM_CC} -fanalyzer -mcpu=cortex-m3 -mthumb -ffreestanding -fshort-enums -O2 -std=gnu11 -Wall -Wextra -Wconversion -Wshadow
        -Werror -DKB_TARGET_STM32 -I${SOURCE} -I${dir}/stm32 -S -o /dev/null ${source}
      COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  if(CPPCHECK)
    execute_process(
      COMMAND ${CPPCHECK} --quiet --error-exitcode=1 --enable=warning,performance,portability --std=c11 -DKB_TARGET_STM32 -I${SOURCE}
        -I${dir}/stm32 --suppress=missingIncludeSystem --suppress=shiftNegativeLHS --suppress=shiftNegative ${dir}/stm32
      COMMAND_ERROR_IS_FATAL ANY)
  endif()
endif()
message(STATUS "${count} sources clean for all time bases")
