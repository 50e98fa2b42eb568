extremal_package(tomlplusplus)
target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:tomlplusplus::tomlplusplus>)
target_compile_definitions(${target} PRIVATE
    EXTREMAL_INSTALLED_SYSTEMS="${CMAKE_INSTALL_FULL_DATADIR}/extremal/problems/systems"
    EXTREMAL_SOURCE_SYSTEMS="${PROJECT_SOURCE_DIR}/problems/systems")
