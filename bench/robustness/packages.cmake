find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
target_link_libraries(${target} PRIVATE CLI11::CLI11 nlohmann_json::nlohmann_json)
target_sources(${target} PRIVATE precision/command.cpp)
