# Sums of two doubles, without a CMake file.
find_path(QD_INCLUDE_DIR qd/dd_real.h REQUIRED)
find_library(QD_LIBRARY qd REQUIRED)
target_include_directories(${target} SYSTEM PUBLIC $<BUILD_INTERFACE:${QD_INCLUDE_DIR}>)
target_link_libraries(${target} PUBLIC ${QD_LIBRARY})
