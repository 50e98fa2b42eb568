find_package(nlohmann_json REQUIRED)
target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
extremal_package(Minizip)
target_link_libraries(${target} PRIVATE minizip::minizip)
# With headers of C.
set_source_files_properties(study/files/archive.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
