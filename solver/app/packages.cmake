find_package(CLI11 REQUIRED)
target_link_libraries(extremal_app PRIVATE CLI11::CLI11)
target_compile_definitions(extremal_app PRIVATE EXTREMAL_VERSION="${PROJECT_VERSION}"
    EXTREMAL_REFERENCE="${CMAKE_INSTALL_FULL_DATADIR}/extremal/problems/README.md")
