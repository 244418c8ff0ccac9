# SPDX-License-Identifier: Apache-2.0
# `cmake --install build/release [--prefix DIR]`: the program finds its device files from DIR/bin.
# `sh DIR/share/servogate/uninstall` takes away what was installed, and nothing else (docs/installing.md).

install(TARGETS servogate RUNTIME DESTINATION bin)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/devices/ DESTINATION share/servogate/devices FILES_MATCHING PATTERN "*.toml")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION share/servogate
        PATTERN "demo" EXCLUDE PATTERN ".gitignore" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION share/doc/servogate PATTERN "machine.schema.json" EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/docs/machine.schema.json DESTINATION share/servogate)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/README.ru.md
              ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION share/doc/servogate)
install(FILES ${PROJECT_SOURCE_DIR}/gateway/system/70-servogate.rules DESTINATION lib/udev/rules.d)

# The manual page and the completion are written by the program itself: one for another processor cannot be asked.
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
  set(WRITTEN OFF)
else()
  set(WRITTEN ON)
endif()
set(HERE ${CMAKE_CURRENT_BINARY_DIR})
set(SYSTEM ${PROJECT_SOURCE_DIR}/gateway/system)
configure_file(${SYSTEM}/install.cmake.in ${HERE}/install-servogate.cmake @ONLY)
install(SCRIPT ${HERE}/install-servogate.cmake)
