# Debian's QD has no CMake file: qd::qd, sums of two doubles.
include(FindPackageHandleStandardArgs)
find_library(QD_LIBRARY qd)
find_path(QD_INCLUDE_DIR qd/dd_real.h)
mark_as_advanced(QD_LIBRARY QD_INCLUDE_DIR)
find_package_handle_standard_args(Qd REQUIRED_VARS QD_LIBRARY QD_INCLUDE_DIR)
if(Qd_FOUND AND NOT TARGET qd::qd)
  add_library(qd::qd UNKNOWN IMPORTED)
  set_target_properties(qd::qd PROPERTIES IMPORTED_LOCATION ${QD_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${QD_INCLUDE_DIR})
endif()
