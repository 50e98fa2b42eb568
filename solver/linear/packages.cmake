# The compiler's own vectorisation of the small kernels costs more than it gains.
set_source_files_properties(linear/chain_small.simd.cpp PROPERTIES COMPILE_OPTIONS -fno-tree-vectorize)

set_source_files_properties(linear/dense.cpp linear/dense_eigen.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)

# SuiteSparse has no CMake file in Debian 12.
find_path(SUITESPARSE_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
target_include_directories(${target} PRIVATE ${SUITESPARSE_INCLUDE_DIR})
foreach(package umfpack cholmod amd suitesparseconfig)
  find_library(SUITESPARSE_${package} ${package} REQUIRED)
  target_link_libraries(${target} PUBLIC ${SUITESPARSE_${package}})
endforeach()
# Error-free sums and products rely on each operation being rounded by itself.
set_source_files_properties(linear/extended_rows.simd.cpp PROPERTIES COMPILE_OPTIONS -ffp-contract=off)
