# Scenes of bench/data and the published cases of tests/data are read as well.
find_package(nlohmann_json REQUIRED)
target_link_libraries(${target} PRIVATE extremal nlohmann_json::nlohmann_json)
# Replaces operator new.
set_source_files_properties(solve/allocation_test.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
