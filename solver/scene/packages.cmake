find_library(TOMLPLUSPLUS_LIBRARY tomlplusplus REQUIRED)
target_link_libraries(${target} PRIVATE ${TOMLPLUSPLUS_LIBRARY})
target_compile_definitions(${target} PRIVATE
    TOML_HEADER_ONLY=0 TOML_SHARED_LIB=1
    EXTREMAL_INSTALLED_PROBLEMS="${CMAKE_INSTALL_FULL_DATADIR}/extremal/problems"
    EXTREMAL_SOURCE_PROBLEMS="${PROJECT_SOURCE_DIR}/problems")
