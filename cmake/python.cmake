# The Python module.

find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module
             OPTIONAL_COMPONENTS Development.SABIModule)
execute_process(COMMAND "${Python_EXECUTABLE}" -m nanobind --cmake_dir
                OUTPUT_STRIP_TRAILING_WHITESPACE OUTPUT_VARIABLE nanobind_ROOT)
find_package(nanobind CONFIG REQUIRED)

# STABLE_ABI gives one wheel for Python 3.12 and later; NB_STATIC keeps the extension in one file.
nanobind_add_module(_core STABLE_ABI NB_STATIC
  core/python/app.cpp
  core/python/c3d.cpp
  core/python/diffma.cpp
  core/python/exact.cpp
  core/python/formats.cpp
  core/python/module.cpp
  core/python/motion.cpp
  core/python/mrpa.cpp
  core/python/near.cpp
  core/python/patterns.cpp
  core/python/qssd.cpp
  core/python/qssd_learning.cpp
  core/python/record.cpp
  core/python/rows.cpp
  core/python/search.cpp
  core/python/skeleton.cpp
  core/python/table.cpp
)
target_link_libraries(_core PRIVATE mocapress_core)
if(MINGW)
  # Windows has none of g++'s libraries.
  target_link_options(_core PRIVATE -static)
endif()

install(TARGETS _core LIBRARY DESTINATION mocapress)

# The page that `mocapress view` shows; a checkout takes it from where it is.
install(DIRECTORY viewer/page viewer/vendor viewer/diffma viewer/mcz viewer/wasm
        DESTINATION mocapress/viewer/web)
