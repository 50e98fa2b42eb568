# zlib's archives have no CMake file: minizip::minizip, the shared library, and its headers.
include(FindPackageHandleStandardArgs)
find_library(MINIZIP_LIBRARY minizip)
find_path(MINIZIP_INCLUDE_DIR minizip/unzip.h)
mark_as_advanced(MINIZIP_LIBRARY MINIZIP_INCLUDE_DIR)
find_package_handle_standard_args(Minizip REQUIRED_VARS MINIZIP_LIBRARY MINIZIP_INCLUDE_DIR)
if(Minizip_FOUND AND NOT TARGET minizip::minizip)
  add_library(minizip::minizip UNKNOWN IMPORTED)
  set_target_properties(minizip::minizip PROPERTIES IMPORTED_LOCATION ${MINIZIP_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${MINIZIP_INCLUDE_DIR})
endif()
