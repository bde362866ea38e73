# SPDX-License-Identifier: Apache-2.0
# Debian packages of what is installed (KerfbenchInstall.cmake), by `cpack -G DEB`; `./bench package` does all of it. The same sources give the
# same bytes: times come from SOURCE_DATE_EPOCH, owners and order from CPack, and nothing that is installed knows where it was built.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Kerfbench maintainers <maintainers@kerfbench.org>")
set(CPACK_PACKAGE_VENDOR "Kerfbench")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL kerfbench emulators dev doc)
# The window is there where its pages were bundled.
file(WRITE ${PROJECT_BINARY_DIR}/package_parts.cmake
"if(EXISTS \"${PROJECT_BINARY_DIR}/window/index.html\")
  list(APPEND CPACK_COMPONENTS_ALL window)
endif()\n")
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_BINARY_DIR}/package_parts.cmake)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# kerfbench_package(emulators NAME kerfbench-emulators FILE name TITLE "one line" TEXT "…" DEPENDS … RECOMMENDS … SUGGESTS … SECTION …)
macro(kerfbench_package component)
  cmake_parse_arguments(PKG "ALL" "NAME;FILE;TITLE;TEXT;SECTION" "DEPENDS;RECOMMENDS;SUGGESTS" ${ARGN})
  string(TOUPPER ${component} upper)
  set(architecture ${CMAKE_LIBRARY_ARCHITECTURE})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${PKG_NAME})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${PKG_TITLE}\n${PKG_TEXT}")
  foreach(relation IN ITEMS DEPENDS RECOMMENDS SUGGESTS)
    list(JOIN PKG_${relation} ", " CPACK_DEBIAN_${upper}_PACKAGE_${relation})
  endforeach()
  if(PKG_SECTION)
    set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${PKG_SECTION})
  endif()
  if(PKG_ALL)
    set(CPACK_DEBIAN_${upper}_PACKAGE_ARCHITECTURE all)
    set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS OFF)
    set(CPACK_DEBIAN_${upper}_FILE_NAME "${PKG_FILE}_${PROJECT_VERSION}_all.deb")
  else()
    set(CPACK_DEBIAN_${upper}_FILE_NAME "${PKG_FILE}_${PROJECT_VERSION}_${kerfbench_architecture}.deb")
  endif()
endmacro()

find_program(DPKG dpkg)
set(kerfbench_architecture amd64)
if(DPKG)
  execute_process(COMMAND ${DPKG} --print-architecture OUTPUT_VARIABLE kerfbench_architecture OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
set(same_version "(= ${PROJECT_VERSION})")

kerfbench_package(kerfbench NAME kerfbench FILE kerfbench
  TITLE "hardware-in-the-loop test bench for laser die-cutters"
  TEXT "Takes a firmware release as it ships, lets its pulses move a model of the
machine that cuts a moving sheet, looks at the cut with cameras, and says
whether every cut is within tolerance, measurement uncertainty included.
.
This package has the programs kerfbench and kerfplan, emulators for the 8051
and the STM32F103, and the shipped scenarios, machines and releases."
  RECOMMENDS "kerfbench-emulators ${same_version}"
  SUGGESTS povray python3-ezdxf python3-svgelements mupdf-tools bubblewrap "kerfbench-doc ${same_version}" "kerfbench-window ${same_version}")
# Its file's name begins as that of kerfbench, so that `apt install ./kerfbench_*.deb` installs what a run needs.
kerfbench_package(emulators NAME kerfbench-emulators FILE kerfbench_emulators
  TITLE "emulator for AVR images and sampler for logic analysers"
  TEXT "Programs that kerfbench starts: kerfbench-avr runs AVR images by simavr, and
kerfbench-sigrok samples logic analysers by libsigrok. They are a package of
their own because they are under the GPL, as these libraries are."
  DEPENDS "kerfbench ${same_version}")
kerfbench_package(window NAME kerfbench-window FILE kerfbench-window
  TITLE "window of the test bench for laser die-cutters"
  TEXT "Pages that kerfbench serve and kerfbench view show in a browser: jobs, runs,
the machine in motion, and recorded traces."
  DEPENDS "kerfbench ${same_version}")
set(httplib)
if(HTTPLIB_FOUND)
  set(httplib libcpp-httplib-dev)
endif()
kerfbench_package(dev NAME kerfbench-dev FILE kerfbench-dev SECTION libdevel
  TITLE "CMake package of the test bench for laser die-cutters"
  TEXT "Headers, static libraries and the CMake package kerfbench: one target for each
part of the bench, for checks and sources of one's own. An example is in
/usr/share/doc/kerfbench-dev/examples."
  DEPENDS "kerfbench ${same_version}" libbullet-dev libeigen3-dev libopencv-dev libpng-dev libjpeg-dev libyaml-cpp-dev libfmt-dev
    nlohmann-json3-dev libpugixml-dev libssl-dev libgpiod-dev libzip-dev libqpdf-dev libxxhash-dev libzstd-dev zlib1g-dev ${httplib}
  SUGGESTS cmake)
kerfbench_package(doc NAME kerfbench-doc FILE kerfbench-doc SECTION doc ALL
  TITLE "documentation of the test bench for laser die-cutters"
  TEXT "Tutorial, how-to guides, reference of scenarios, machines, checks, commands and
file formats, and the reasons behind them, as pages to read without a network.")
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)

include(CPack)
