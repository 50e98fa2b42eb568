# Solvers of other libraries, each of which may be left out.
# Debian's Ceres is a static library with instances of Eigen's templates, which allocate in another way under
# the address sanitizer: the linker would mix both.
if(EXTREMAL_SANITIZE MATCHES "address")
  set(EXTREMAL_CERES_DEFAULT OFF)
else()
  set(EXTREMAL_CERES_DEFAULT ON)
endif()
option(EXTREMAL_CERES "Least squares by Ceres Solver: method = \"ceres\"" ${EXTREMAL_CERES_DEFAULT})
option(EXTREMAL_IPOPT "Interior points by Ipopt: method = \"ipopt\"" ON)
if(EXTREMAL_CERES)
  extremal_package(Ceres)
  target_link_libraries(${target} PRIVATE Ceres::ceres)
  target_compile_definitions(${target} PRIVATE EXTREMAL_CERES)
else()
  set_source_files_properties(solve/external/least_squares.cpp solve/external/curve_fit.cpp PROPERTIES HEADER_FILE_ONLY ON)
endif()
if(EXTREMAL_IPOPT)
  extremal_package(Ipopt)
  target_link_libraries(${target} PRIVATE ipopt::ipopt)
  target_compile_definitions(${target} PRIVATE EXTREMAL_IPOPT)
else()
  set_source_files_properties(solve/external/interior_point.cpp PROPERTIES HEADER_FILE_ONLY ON)
endif()
# Hot, or with limits of their own by the names of another file's.
set_source_files_properties(solve/mesh/resolution.cpp solve/adapt/refinement.cpp solve/accept/quadrature_check.cpp
    solve/accept/conjugate_ends.cpp solve/search/gradient_flow.cpp
    solve/external/curve_fit.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
