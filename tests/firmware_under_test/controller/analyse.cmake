# SPDX-License-Identifier: Apache-2.0
# Static analysis of the controller's C, for both time bases: GCC's analyser, and cppcheck where there is one.
#
#     cmake -DCC=gcc -DCPPCHECK=cppcheck -DSOURCE=ROOT -P analyse.cmake
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
message(STATUS "${count} sources clean for both time bases")
