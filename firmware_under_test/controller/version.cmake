# SPDX-License-Identifier: Apache-2.0
# Writes the header with the version that a release carries: the project's number and the first digits of the SHA-256 of the controller's
# sources, so that the same sources give the same version wherever they lie.
#
#     cmake -DSOURCE=ROOT -DVERSION=0.1.0 -DOUT=kb_version.h -P version.cmake
set(dir ${SOURCE}/firmware_under_test/controller)
file(GLOB_RECURSE sources RELATIVE ${dir} ${dir}/*.c ${dir}/*.h ${dir}/*.cmake)
list(SORT sources)
set(digests "${VERSION}\n")
foreach(source IN LISTS sources)
  file(SHA256 ${dir}/${source} digest)
  string(APPEND digests "${digest} ${source}\n")
endforeach()
string(SHA256 digest "${digests}")
string(SUBSTRING ${digest} 0 12 digest)
file(CONFIGURE OUTPUT ${OUT} CONTENT "#define KB_VERSION \"${VERSION}+${digest}\"\n" @ONLY)
