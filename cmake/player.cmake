# libmocapress, the C library.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
find_package(LibLZMA REQUIRED)
find_package(ZLIB REQUIRED)

# Files are packed with a preset dictionary, which becomes a part of the library.
file(READ "${PROJECT_SOURCE_DIR}/src/mocapress/container/dictionary1.bin" DICTIONARY HEX)
string(REGEX REPLACE "(..)" "0x\\1," DICTIONARY "${DICTIONARY}")
configure_file(core/player/dictionary.cpp.in dictionary.cpp @ONLY)

add_library(mocapress SHARED
  "${CMAKE_CURRENT_BINARY_DIR}/dictionary.cpp"
  core/player/clip.cpp
  core/player/decoding.cpp
  core/player/head.cpp
  core/player/mocapress.cpp
  core/player/packing.cpp
  core/player/sections.cpp
)
target_include_directories(mocapress
  PRIVATE core
  PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>"
         "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
target_compile_options(mocapress PRIVATE -O3 -ffp-contract=off -fno-math-errno -Wno-psabi -Wall -Wextra
                                         -Wpedantic)
target_link_libraries(mocapress PRIVATE mocapress_core LibLZMA::LibLZMA ZLIB::ZLIB)
set_target_properties(mocapress PROPERTIES
  CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
  VERSION ${PROJECT_VERSION} SOVERSION 0
  PUBLIC_HEADER include/mocapress.h)

install(TARGETS mocapress EXPORT mocapress
        PUBLIC_HEADER DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT mocapress NAMESPACE mocapress:: FILE mocapress-targets.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/mocapress)
configure_package_config_file(cmake/mocapress-config.cmake.in mocapress-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/mocapress)
write_basic_package_version_file(mocapress-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/mocapress-config.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/mocapress-config-version.cmake"
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/mocapress)
