# SPDX-License-Identifier: Apache-2.0
# Builds one MCS-51 release with SDCC: OUT.hex. Sizes are those of an STC15W4K32S4; what does not fit is an error of the linker.
#
#     cmake -DSDCC=sdcc -DSOURCE=ROOT -DVERSION_HEADER=kb_version.h "-DSOURCES=core/belt.c;…" "-DDEFINES=KB_…" -DOUT=firmware/controller-mcs51 -P build_mcs51.cmake
set(dir ${SOURCE}/firmware_under_test/controller)
set(objects)
list(TRANSFORM DEFINES PREPEND -D)
foreach(source IN LISTS SOURCES)
  string(REPLACE "/" "-" name ${source})
  set(object ${OUT}.parts/${name}.rel)
  file(MAKE_DIRECTORY ${OUT}.parts)
  # 110 and 126: comparisons of constants that another target decides otherwise; 85: an argument that it needs; 147: a text
  # without its final zero.
  execute_process(
    COMMAND ${SDCC} -mmcs51 --model-large --std-c11 --opt-code-speed --disable-warning 85 --disable-warning 110 --disable-warning 126
      --disable-warning 147 --Werror -DKB_TARGET_MCS51 ${DEFINES} "-Wp -include,${VERSION_HEADER}" -I${SOURCE} -I${dir}/mcs51 -I${dir}/core -c ${dir}/${source} -o ${object}
    COMMAND_ERROR_IS_FATAL ANY)
  list(APPEND objects ${object})
endforeach()
execute_process(
  COMMAND ${SDCC} -mmcs51 --model-large --code-size 32768 --iram-size 256 --xram-size 3840 ${objects} -o ${OUT}.parts/release.ihx
  COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${OUT}.parts/release.ihx ${OUT}.hex)
