# What an installation holds: the libraries, their headers, the command, the problems, and a package for
# find_package(extremal). EXTREMAL_PACKAGES, filled beside the folders, are the packages that the exported
# targets name.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/extremal)
set(EXTREMAL_PROBLEMS_DIR ${CMAKE_INSTALL_DATADIR}/extremal/problems)

install(TARGETS ${EXTREMAL_TARGETS} EXPORT extremalTargets)
if(TARGET extremal_app)
  install(TARGETS extremal_app)
endif()
install(DIRECTORY solver/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/extremal
        FILES_MATCHING PATTERN *.hpp PATTERN app EXCLUDE)
install(DIRECTORY problems/ DESTINATION ${EXTREMAL_PROBLEMS_DIR} FILES_MATCHING PATTERN *.toml PATTERN *.csv)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/extremal)

get_property(packages GLOBAL PROPERTY EXTREMAL_PACKAGES)
list(REMOVE_DUPLICATES packages)
list(TRANSFORM packages REPLACE "(.+)" "find_dependency(\\1)")
list(JOIN packages "\n" EXTREMAL_DEPENDENCIES)
configure_package_config_file(cmake/extremalConfig.cmake.in extremalConfig.cmake
    INSTALL_DESTINATION ${package_dir} PATH_VARS EXTREMAL_PROBLEMS_DIR)
write_basic_package_version_file(extremalConfigVersion.cmake COMPATIBILITY SameMinorVersion)
file(GLOB find_modules cmake/Find*.cmake)
install(FILES ${PROJECT_BINARY_DIR}/extremalConfig.cmake ${PROJECT_BINARY_DIR}/extremalConfigVersion.cmake
        ${find_modules} DESTINATION ${package_dir})
install(EXPORT extremalTargets NAMESPACE extremal:: DESTINATION ${package_dir})
