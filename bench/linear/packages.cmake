# LAPACK's banded LU is run beside ours where there is one.
find_library(LAPACK_LIBRARY lapack)
if(LAPACK_LIBRARY)
  target_link_libraries(${target} PRIVATE ${LAPACK_LIBRARY})
  target_compile_definitions(${target} PRIVATE EXTREMAL_HAS_LAPACK)
endif()
