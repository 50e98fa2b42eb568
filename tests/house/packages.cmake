# The program writes what pages describe.
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
target_link_libraries(${target} PRIVATE nlohmann_json::nlohmann_json tomlplusplus::tomlplusplus)
if(TARGET extremal_app)
  add_dependencies(${target} extremal_app)
endif()
