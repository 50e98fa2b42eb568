# Replaces operator new.
set_source_files_properties(linear/allocation_test.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
# Dense oracles by Eigen, which would run for minutes without any optimisation.
target_compile_options(${target} PRIVATE -O1)
