# Debian's SLEEF has no CMake file: sleef::sleef, the vectorised elementary functions.
include(FindPackageHandleStandardArgs)
find_library(SLEEF_LIBRARY sleef)
find_path(SLEEF_INCLUDE_DIR sleef.h)
mark_as_advanced(SLEEF_LIBRARY SLEEF_INCLUDE_DIR)
find_package_handle_standard_args(Sleef REQUIRED_VARS SLEEF_LIBRARY SLEEF_INCLUDE_DIR)
if(Sleef_FOUND AND NOT TARGET sleef::sleef)
  add_library(sleef::sleef UNKNOWN IMPORTED)
  set_target_properties(sleef::sleef PROPERTIES IMPORTED_LOCATION ${SLEEF_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${SLEEF_INCLUDE_DIR})
endif()
