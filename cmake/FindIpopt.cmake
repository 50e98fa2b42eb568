# Ipopt has no CMake file: ipopt::ipopt, the shared library alone, which knows what it needs itself, and its headers
# with the flags that pkg-config tells.
include(FindPackageHandleStandardArgs)
find_package(PkgConfig QUIET)
if(PKG_CONFIG_FOUND)
  pkg_check_modules(PC_IPOPT QUIET ipopt)
endif()
find_library(IPOPT_LIBRARY ipopt HINTS ${PC_IPOPT_LIBRARY_DIRS})
find_path(IPOPT_INCLUDE_DIR IpTNLP.hpp HINTS ${PC_IPOPT_INCLUDE_DIRS} PATH_SUFFIXES coin coin-or)
mark_as_advanced(IPOPT_LIBRARY IPOPT_INCLUDE_DIR)
find_package_handle_standard_args(Ipopt REQUIRED_VARS IPOPT_LIBRARY IPOPT_INCLUDE_DIR)
if(Ipopt_FOUND AND NOT TARGET ipopt::ipopt)
  add_library(ipopt::ipopt UNKNOWN IMPORTED)
  set_target_properties(ipopt::ipopt PROPERTIES IMPORTED_LOCATION ${IPOPT_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${IPOPT_INCLUDE_DIR}
                        INTERFACE_COMPILE_OPTIONS "${PC_IPOPT_CFLAGS_OTHER}")
endif()
