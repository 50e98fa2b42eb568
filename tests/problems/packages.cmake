find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
target_link_libraries(${target} PRIVATE nlohmann_json::nlohmann_json tomlplusplus::tomlplusplus)
