find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
target_link_libraries(${target} PRIVATE CLI11::CLI11 nlohmann_json::nlohmann_json)

# Shooting by hand is compiled for the processor that measures it.
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-march=native EXTREMAL_NATIVE)
add_library(bench_shooting OBJECT ${folder}/shooting/shooting.cpp)
target_include_directories(bench_shooting PRIVATE ${PROJECT_SOURCE_DIR}/solver)
target_compile_options(bench_shooting PRIVATE -O3 -ffp-contract=fast -fno-math-errno -fno-trapping-math
                       $<$<BOOL:${EXTREMAL_NATIVE}>:-march=native>)
target_link_libraries(bench_shooting PRIVATE extremal_flags)
target_link_libraries(${target} PRIVATE bench_shooting)
