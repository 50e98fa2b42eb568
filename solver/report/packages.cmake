find_package(nlohmann_json REQUIRED)
target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
include(${CMAKE_CURRENT_LIST_DIR}/viewer/viewer.cmake)
